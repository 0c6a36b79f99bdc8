"""Pictures and rays of MuJoCo models, in turn with `mujoco.Renderer` and `mujoco.mj_multiRay`, in processor time.

    python -m benchmarks.programs.eyes                      # the models of Gymnasium
    python -m benchmarks.programs.eyes --scenes             # the 25 models of `benchmarks.programs.looks`
    python -m benchmarks.programs.eyes --packages gymnasium dm_control gymnasium_robotics robosuite
    python -m benchmarks.programs.eyes scenes/*.xml         # others
    MUJOCO_GL=osmesa python -m benchmarks.programs.eyes     # another OpenGL in software

`mujoco.Renderer` needs PyOpenGL and a library: EGL, unless ``MUJOCO_GL`` names another one. All states move between
pictures. Pictures whose depths differ from those of OpenGL in more than 2 % of the pixels, and rays whose geoms differ
in more than 1 %, do not count, and are named.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np

import morse
from benchmarks.programs.looks import SCENES, folder_of

if TYPE_CHECKING:
    from collections.abc import Callable

_CHUNKS = 5
_WORLDS, _RAYS = 64, 1024
#: squares along the side of the mesh whose preparation is measured: 1 M triangles
_SIDE = 708
_RENDERERS = 20


def reference(model: Any, height: int, width: int) -> Any:
    """A renderer of MuJoCo."""
    return mujoco.Renderer(model, height, width, max_geom=20000)


def why_no_opengl() -> str:
    """Why MuJoCo's renderer cannot be created; empty if it can."""
    try:
        model = mujoco.MjModel.from_xml_string("<mujoco/>")
        reference(model, 8, 8).close()
    except Exception as error:
        return f"{type(error).__name__}: {error}".splitlines()[0]
    return ""


def in_turns(*actions: Callable[[], object], repeats: int = 3) -> list[float]:
    """Processor time of each action, ms: medians over turns."""
    spent: list[list[float]] = [[] for _ in actions]
    for turn in range(_CHUNKS + 1):
        for action, times in zip(actions, spent, strict=True):
            begin = time.process_time()
            for _ in range(repeats):
                action()
            if turn:  # the first ones take longer
                times.append(1e3 * (time.process_time() - begin) / repeats)
    return [statistics.median(times) for times in spent]


class Scene:
    """A model with its moving state.

    Args:
        file: MJCF.
        opengl: whether there is OpenGL.
    """

    def __init__(self, file: str, opengl: bool) -> None:
        self.model = model = mujoco.MjModel.from_xml_path(file)
        buffer = model.vis.global_
        buffer.offwidth, buffer.offheight = max(buffer.offwidth, 640), max(buffer.offheight, 480)
        self.opengl, self.camera = opengl, 0 if model.ncam else -1
        self.states = [self._state(row) for row in range(_WORLDS)]
        self._turn = 0

    def _state(self, row: int) -> Any:
        data = mujoco.MjData(self.model)
        if self.model.nkey:
            mujoco.mj_resetDataKeyframe(self.model, data, 0)
        mujoco.mj_step(self.model, data, 1 + row)
        mujoco.mj_forward(self.model, data)
        return data

    def pictures(self, height: int, width: int, kinds: tuple[str, ...]) -> list[float]:
        """Processor time of pictures of ours and of OpenGL, ms."""
        renderers = [morse.Renderer(self.model, height, width)]
        if self.opengl:
            renderers.append(reference(self.model, height, width))
            self._compare(*renderers)
        times = in_turns(*(lambda r=r: self._draw(r, kinds) for r in renderers))
        for renderer in renderers:
            renderer.close()
        return times

    def _draw(self, renderer: Any, kinds: tuple[str, ...]) -> None:
        self._turn = (self._turn + 1) % _WORLDS
        renderer.update_scene(self.states[self._turn], self.camera)
        for kind in kinds:
            _switch(renderer, kind)
            renderer.render()

    def _compare(self, ours: Any, theirs: Any) -> None:
        depths = []
        for renderer in (ours, theirs):
            renderer.update_scene(self.states[0], self.camera)
            renderer.update_scene(self.states[0], self.camera)
            _switch(renderer, "depth")
            depths.append(renderer.render().copy())
        same = np.isclose(depths[0], depths[1], rtol=1e-3, atol=1e-3).mean()
        if same < 0.98:
            raise RuntimeError(f"the depths of {1 - same:.1%} of the pixels differ from those of OpenGL")

    def batch(self, size: int) -> list[float]:
        """Processor time of a picture of a batch, and of a single picture, ms."""
        with (
            morse.Renderer.batch(self.model, _WORLDS, size, size) as batch,
            morse.Renderer(self.model, size, size) as single,
        ):

            def singles() -> None:
                for data in self.states:
                    single.update_scene(data, self.camera)
                    single.render()

            return [
                spent / _WORLDS
                for spent in in_turns(lambda: batch.render(self.states, self.camera), singles, repeats=1)
            ]

    def rays(self, worlds: int, normals: bool = False) -> list[float]:
        """Processor time of rays at that many worlds, of ours and of MuJoCo, ms."""
        ways = np.random.default_rng(1).normal(size=(_RAYS, 3))
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        point = self.model.stat.center + np.array([0.0, 0.0, 0.5 * self.model.stat.extent])
        ours, states = morse.Rays(self.model), self.states[:worlds]
        geoms, distances = np.zeros(_RAYS, np.int32), np.zeros(_RAYS)
        sides = np.zeros(3 * _RAYS) if normals else None

        def theirs() -> None:
            for data in states:
                mujoco.mj_multiRay(
                    self.model, data, point, ways.ravel(), None, 1, -1, geoms, distances, sides, _RAYS, 1e10
                )

        theirs()
        same = (ours.cast(states, point, ways, normals=False).geoms[-1] == geoms).mean()
        if same < 0.99:
            raise RuntimeError(f"{1 - same:.1%} of the rays hit other geoms than those of mj_multiRay")
        return in_turns(lambda: ours.cast(states, point, ways, normals=normals), theirs, repeats=max(1, 8 // worlds))


def _switch(renderer: Any, kind: str) -> None:
    renderer.disable_depth_rendering()
    renderer.disable_segmentation_rendering()
    if kind != "rgb":
        (renderer.enable_depth_rendering if kind == "depth" else renderer.enable_segmentation_rendering)()


def preparation() -> dict[str, float]:
    """Processor time of the first picture of a mesh of 1 M triangles, and of that of a further renderer, s."""
    x, y = np.meshgrid(np.arange(_SIDE), np.arange(_SIDE))
    points = np.stack([x, y, 10 * np.sin(x / 30) * np.cos(y / 30)], axis=-1).reshape(-1, 3) / 100
    at = np.arange(_SIDE * _SIDE, dtype=np.int32).reshape(_SIDE, _SIDE)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    faces = np.concatenate([np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))])
    spec = mujoco.MjSpec()
    mesh = spec.add_mesh(name="mesh")
    mesh.uservert, mesh.userface = points.ravel(), faces.ravel()
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="mesh")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    taken, kept = {}, []
    for name in ("prepare_1M_s", "further_1M_s"):
        begin = time.process_time()
        kept.append(_shown(model, data))
        taken[name] = time.process_time() - begin
    return taken


def _shown(model: Any, data: Any) -> Any:
    renderer = morse.Renderer(model, 256, 256)
    renderer.update_scene(data)
    renderer.render()
    return renderer


def memory(scene: Scene) -> float:
    """Memory of a further renderer of the same model, MB; 0 where the system does not tell."""
    table = Path("/proc/self/statm")
    if not table.exists():
        return 0.0
    kept, before = [_shown(scene.model, scene.states[0])], int(table.read_text().split()[1])
    kept += [_shown(scene.model, scene.states[0]) for _ in range(_RENDERERS)]
    return (int(table.read_text().split()[1]) - before) * os.sysconf("SC_PAGE_SIZE") / 1e6 / _RENDERERS


def measurements(scene: Scene) -> dict[str, list[float]]:
    """Pairs of times of a scene, ms: ours first."""
    return {
        "256 x 256, colours": scene.pictures(256, 256, ("rgb",)),
        "640 x 480, colours, depths, ids": scene.pictures(480, 640, ("rgb", "depth", "ids")),
        f"128 x 128, of a batch of {_WORLDS}, and single": scene.batch(128),
        f"{_RAYS} rays, 1 world": scene.rays(1),
        f"{_RAYS} rays, {_WORLDS} worlds": scene.rays(_WORLDS),
        f"{_RAYS} rays with normals, 1 world": scene.rays(1, normals=True),
        f"{_RAYS} rays with normals, {_WORLDS} worlds": scene.rays(_WORLDS, normals=True),
    }


#: models of packages, with their own patterns: those of robosuite are worlds, which its robots are put into
_PACKAGES = {
    "gymnasium": ("envs/mujoco/assets/*.xml",),
    "dm_control": ("suite/*.xml",),
    "gymnasium_robotics": ("envs/assets/fetch/*.xml", "envs/assets/hand/*.xml", "envs/assets/adroit_hand/adroit_*.xml"),
    "robosuite": ("models/assets/arenas/*.xml", "models/assets/robots/*/robot.xml"),
}


def models_of_packages(names: list[str]) -> list[str]:
    """The models that packages have."""
    files: list[str] = []
    for name in names:
        files += [str(file) for pattern in _PACKAGES[name] for file in folder_of(name).glob(pattern)]
    return files


def scenes() -> list[str]:
    """The models of `benchmarks.programs.looks`."""
    return [str(folder_of(package) / name) for package, name in SCENES]


def main() -> None:
    """Measure all scenes, and print the medians."""
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*", help="MJCF files (default: those of Gymnasium)")
    parser.add_argument("--packages", nargs="+", default=["gymnasium"], choices=list(_PACKAGES), help="whose models")
    parser.add_argument(
        "--scenes", action="store_true", help="25 models of four packages, see benchmarks.programs.looks"
    )
    parser.add_argument("--each", action="store_true", help="print each scene, too")
    given = parser.parse_args()
    why = why_no_opengl()
    print(f"mujoco.Renderer cannot be created, {why}" if why else f"mujoco.Renderer: {os.environ['MUJOCO_GL']}")
    total: dict[str, list[list[float]]] = {}
    grown = []
    files = given.files or (scenes() if given.scenes else models_of_packages(given.packages))
    for file in sorted(files):
        try:
            scene = Scene(file, not why)
            found = measurements(scene)
        except (RuntimeError, ValueError, mujoco.FatalError) as error:
            print(f"{file} does not count: {error}", file=sys.stderr)
            continue
        grown.append(memory(scene))
        for name, times in found.items():
            total.setdefault(name, []).append(times)
        if given.each:
            print(file, json.dumps({name: [round(t, 3) for t in times] for name, times in found.items()}), flush=True)
    if not grown:
        raise SystemExit("No scene counts.")
    print(f"{len(grown)} scenes, medians\n\n| | MORSE, ms | other, ms | other / MORSE |\n|---|--:|--:|--:|")
    for name, rows in total.items():
        columns = [statistics.median(column) for column in zip(*rows, strict=True)]
        columns += [float("nan")] * (2 - len(columns))
        ratio = statistics.median(row[-1] / row[0] for row in rows) if len(rows[0]) == 2 else float("nan")
        print(f"| {name} | {' | '.join(f'{value:.2f}' for value in columns)} | {ratio:.1f} |")
    print(json.dumps({**preparation(), "further_renderer_mb": statistics.median(grown)}))


if __name__ == "__main__":
    main()
