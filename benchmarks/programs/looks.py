"""Pictures of models of packages by MuJoCo's OpenGL and by both looks of `morse.Renderer`, side by side.

    python -m benchmarks.programs.looks docs/pictures/mujoco-scenes.webp

Each scene has four: MuJoCo's own renderer (EGL, unless ``MUJOCO_GL`` names another library), the classic look, their
difference around grey, and the look of scenes. Needs PyOpenGL, Gymnasium, dm_control, Gymnasium-Robotics and robosuite.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np
from PIL import Image

import morse

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SIZE, _COLUMNS = 128, 3
#: 25 models: their packages and files
SCENES = [
    *[
        ("gymnasium", f"envs/mujoco/assets/{name}.xml")
        for name in ("ant", "half_cheetah", "hopper", "humanoid", "pusher_v5", "reacher", "swimmer", "walker2d_v5")
    ],
    *[
        ("dm_control", f"suite/{name}.xml")
        for name in ("acrobot", "ball_in_cup", "cartpole", "dog", "finger", "fish", "humanoid", "lqr", "manipulator")
    ],
    *[("dm_control", f"suite/{name}.xml") for name in ("quadruped", "stacker", "swimmer")],
    ("gymnasium_robotics", "envs/assets/fetch/pick_and_place.xml"),
    ("gymnasium_robotics", "envs/assets/hand/manipulate_block.xml"),
    ("gymnasium_robotics", "envs/assets/adroit_hand/adroit_door.xml"),
    ("robosuite", "models/assets/arenas/table_arena.xml"),
    ("robosuite", "models/assets/arenas/bins_arena.xml"),
]


def folder_of(package: str) -> Path:
    """The folder of a package."""
    found = importlib.util.find_spec(package)
    if found is None or not found.submodule_search_locations:
        raise SystemExit(f"{package} is not installed: install it, or name MJCF files.")
    return Path(found.submodule_search_locations[0])


def picture(renderer: Any, data: Any, camera: int) -> NDArray[np.uint8]:
    """A picture of a state."""
    renderer.update_scene(data, camera)
    # some geoms are placed around the camera of the last call
    renderer.update_scene(data, camera)
    return np.array(renderer.render())


def row(file: Path) -> tuple[NDArray[np.uint8], float]:
    """(H, 4 W, 3) the four pictures, and the peak signal-to-noise ratio of the classic look, dB."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    camera, pictures = (0 if model.ncam else -1), []
    makers = (mujoco.Renderer, morse.Renderer, lambda *size: morse.Renderer(*size, look="morse"))
    for make in makers:
        renderer = make(model, _SIZE, _SIZE)
        pictures.append(picture(renderer, data, camera))
        renderer.close()
    apart = pictures[1].astype(float) - pictures[0]
    error = float((apart**2).mean())
    difference = np.clip(128 + apart, 0, 255).astype(np.uint8)
    return np.concatenate([*pictures[:2], difference, pictures[2]], axis=1), 10 * np.log10(255**2 / max(error, 1e-3))


def main() -> None:
    """Draw all scenes, and print the ratios."""
    parser = argparse.ArgumentParser(description="Pictures of 25 models, side by side.")
    parser.add_argument("file", help="picture that is written, such as mujoco-scenes.webp")
    given = parser.parse_args()
    rows, ratios = [], []
    for package, name in SCENES:
        pictures, ratio = row(folder_of(package) / name)
        print(f"{package}/{name}: {ratio:.1f} dB", flush=True)
        rows.append(pictures)
        ratios.append(ratio)
    blank = np.full_like(rows[0], 255)
    lines = [rows[n : n + _COLUMNS] for n in range(0, len(rows), _COLUMNS)]
    grid = [np.concatenate([*line, *[blank] * (_COLUMNS - len(line))], axis=1) for line in lines]
    Image.fromarray(np.concatenate(grid)).save(given.file, quality=70)
    print(f"median {np.median(ratios):.1f} dB, {sum(ratio >= 30 for ratio in ratios)} of {len(ratios)} at least 30 dB")


if __name__ == "__main__":
    main()
