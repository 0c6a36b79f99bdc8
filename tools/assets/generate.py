"""Make one model file. Runs inside Blender:

    blender -b --factory-startup -noaudio --python-exit-code 3 --python tools/assets/generate.py -- OUTDIR robots/morsy

The script of the model, e.g. ``robots/morsy.py``, has a function ``build()`` that fills the empty scene.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import bpy

from mathutils import Euler

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True


def main() -> None:
    out, *names = sys.argv[sys.argv.index("--") + 1 :]
    for name in names:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        tidy_scene()
        runpy.run_path(str(HERE / f"{name}.py"))["build"]()
        frame_views()
        forget_home()
        target = Path(out).resolve() / f"{name}.blend"
        target.parent.mkdir(parents=True, exist_ok=True)
        bpy.context.preferences.filepaths.save_version = 0
        bpy.ops.wm.save_as_mainfile(filepath=str(target), compress=False)


def tidy_scene() -> None:
    scene = bpy.context.scene
    scene.unit_settings.system = "METRIC"
    scene.render.filepath = "//render/"
    scene.view_settings.view_transform = "Standard"


def frame_views() -> None:
    """The initial view of the file: the whole model, from the front left, in its colours."""
    corners = [o.matrix_world @ v.co for o in bpy.data.objects if o.type == "MESH" for v in o.data.vertices]
    low, high = ([f(c[i] for c in corners) for i in range(3)] for f in (min, max))
    for screen in bpy.data.screens:
        for space in (s for area in screen.areas for s in area.spaces if s.type == "VIEW_3D"):
            space.shading.type = "MATERIAL"
            space.clip_end = 500.0
            view = space.region_3d
            view.view_location = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
            view.view_distance = 1.6 * max(b - a for a, b in zip(low, high, strict=True))
            view.view_rotation = Euler((1.2, 0.0, 0.96)).to_quaternion()


def forget_home() -> None:
    """Remove home directories from the file browsers of the new file."""
    spaces = (
        s for screen in bpy.data.screens for area in screen.areas for s in area.spaces if s.type == "FILE_BROWSER"
    )
    for params in (space.params for space in spaces if space.params):
        params.directory = b"/" * 200  # a short path alone would leave the rest of the old path in memory
        params.directory = b"//"


main()
