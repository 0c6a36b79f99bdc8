"""Images of the same triangles by MuJoCo's own renderer: OpenGL, in software without a graphics card.

``mujoco_pictures FILE``, with a file written by ``benchmarks.programs.pictures export``. Every image is a separate
pass, as in the renderer of MuJoCo; surfaces have one colour each, and no textures.
"""

from __future__ import annotations

import argparse
import math
import os

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np

from benchmarks import stopwatch, work

_CHUNK = 2
_WARM = 2


def model(path: str, samples: int, width: int) -> mujoco.MjModel:
    """All instances as meshes without collision, a sun, and the camera."""
    spec = mujoco.MjSpec()
    spec.visual.quality.offsamples = 0 if samples == 1 else 4
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, width * 3 // 4
    spec.visual.map.znear, spec.visual.map.zfar = work.PICTURE_NEAR, work.PICTURE_FAR
    spec.stat.extent = 1.0
    spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, pos=(9, -11, 15), dir=(-0.45, 0.55, -0.75))
    eye, target = np.array(work.PICTURE_EYE), np.array(work.PICTURE_TARGET)
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross((0.0, 0.0, 1.0), back)
    right /= np.linalg.norm(right)
    fovy = math.degrees(2 * math.atan(0.75 * 16.0 / work.PICTURE_FOCAL))
    camera = spec.worldbody.add_camera(name="eye", pos=eye, fovy=fovy)
    camera.alt.type = mujoco.mjtOrientation.mjORIENTATION_XYAXES
    camera.alt.xyaxes = [*right, *np.cross(back, right)]
    with np.load(path) as made:
        for number in range(int(made["count"])):
            spec.add_mesh(
                name=str(number),
                uservert=made[f"v{number}"].astype(np.float32).ravel(),
                userface=made[f"t{number}"].astype(np.int32).ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=str(number),
                rgba=made[f"c{number}"],
                contype=0,
                conaffinity=0,
            )
    return spec.compile()


def main() -> None:
    """Render as fast as possible."""
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--samples", type=int, default=5)
    parser.add_argument("--no-color", action="store_true")
    parser.add_argument("--no-shadows", action="store_true")
    given = parser.parse_args()
    made = model(given.file, given.samples, given.width)
    data = mujoco.MjData(made)
    mujoco.mj_forward(made, data)
    renderer = mujoco.Renderer(made, given.width * 3 // 4, given.width, max_geom=made.ngeom + 100)
    depth = np.zeros((given.width * 3 // 4, given.width), np.float32)

    def draw() -> None:
        renderer.update_scene(data, "eye")
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = not given.no_shadows
        if not given.no_color:
            renderer.render()
        renderer.enable_depth_rendering()
        renderer.render(out=depth)
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        renderer.render()
        renderer.disable_segmentation_rendering()

    for _ in range(_WARM):
        draw()
    cost = stopwatch.cost_of(draw, _CHUNK)
    stopwatch.report(ms=1e3 * cost.wall, processor_ms=1e3 * cost.processor, depths=work.depth_grid(depth.tolist()))


if __name__ == "__main__":
    main()
