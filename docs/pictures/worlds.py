"""Create the pictures of all worlds, by the renderer of MORSE: ``python docs/pictures/worlds.py [NAME...]``."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

import morse
from morse.assets import find, load, search

if TYPE_CHECKING:
    from morse.scene import Node

FOLDER = Path(__file__).with_name("worlds")
SIZE = (480, 300)
#: m: the part of a larger world that is shown, and what it takes to show what some worlds are named after
_WIDEST = 25.0
_REACHES = {"indoors-1/boxes": 9.5, "land-1/rosace_1": 80.0, "land-1/trees": 55.0, "land-1/buildings_1": 95.0}
#: where a camera looks from, per reach of what it shows; the usual corner of a world may be in a tree
_EYE, _EYES = (0.55, -0.75, 0.75), {"outdoors": (-0.75, -0.6, 0.6)}
#: the height of the surface in worlds of water, m: a boat on it or below shows the size of what is seen, from nearby
_WATER = {"water-1/deep_water": 0.0, "water-1/water_scene": 4.2}
_DEPTHS, _DIVER = {"water-1/deep_water": 1.5}, (0.55, -0.75, 0.11)
_BOAT, _NEARBY = "boat = Submarine()\nboat.translate({0:.3f}, {1:.3f}, {2:.3f})\n", 5.0


def bounds(roots: list[Node]) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest corner of the meshes, m."""
    points = []
    for node in (node for root in roots for node in root.walk()):
        if node.mesh is not None and len(node.mesh.vertices) and node.visible:
            matrix = np.array([list(row) for row in node.world_matrix()])
            points.append(node.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3])
    everything = np.concatenate(points)
    return np.percentile(everything, 2, axis=0), np.percentile(everything, 98, axis=0)


def picture(name: str) -> Image.Image:
    """A world from a corner above it, as wide as it is, or as a robot can drive in a minute."""
    low, high = bounds(load(find(name, "environments")).roots) if name != "empty" else (-np.ones(3), np.ones(3))
    centre = (low + high) / 2
    centre = np.append(centre[:2], _WATER[name] - _DEPTHS.get(name, 0.0)) if name in _WATER else centre
    reach = min(max(float(np.hypot(*(high - low)[:2])) / 2, 2.0), _WIDEST)
    reach = _NEARBY if name in _WATER else _REACHES.get(name, reach)
    eye = centre + np.array(_DIVER if name in _DEPTHS else _EYES.get(name, _EYE)) * reach * 1.5
    ahead = (centre - eye) / np.linalg.norm(centre - eye)
    rotation = (float(np.arccos(-ahead[2])), 0.0, float(np.arctan2(ahead[0], -ahead[1]) + np.pi))
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "world.py"
        boat = _BOAT.format(*centre) if name in _WATER else ""
        script.write_text(f"from morse.builder import *\n{boat}env = Environment({name!r})\n")
        with morse.load(script) as simulation:
            view = {"location": tuple(map(float, eye)), "rotation": rotation, "focal_length": 28.0}
            return Image.fromarray(simulation.picture(*SIZE, **view))


def main(names: list[str]) -> None:
    """Make the pictures of these worlds, or all."""
    own = search.component_dirs()[0] / "environments"
    FOLDER.mkdir(exist_ok=True)
    for name in search.available("environments"):
        if (own / f"{name}.blend").is_file() and name in (names or [name]):
            picture(name).save(FOLDER / f"{name.replace('/', '-')}.webp", quality=72, method=6)
            print(name)


if __name__ == "__main__":
    main(sys.argv[1:])
