"""Cameras under water see the colour of water, darker with the depth, and nothing far away."""

import numpy as np
import pytest

import morse
from morse.builder import Cube, Environment, FakeRobot, PassiveObject
from morse.scene.extent import water_level

LOOK = {"rotation": (1.5708, 0.0, 0.0), "focal_length": 24.0}


def sea() -> None:
    """Boxes 3 m and 60 m from the origin, 4 m under water."""
    for y in (3.0, 60.0):
        box = PassiveObject("props/crates", object_name="small_crate")
        box.translate(0.0, y, -4.0)
        box.static()
    FakeRobot()
    Environment("water-1/deep_water")


def test_the_colour_of_water_hides_what_is_far() -> None:
    with morse.load(sea) as simulation:
        assert water_level(simulation.scene) == pytest.approx(0.0)

        def image(depth: float, y: float = 0.0) -> np.ndarray:
            pixels: np.ndarray = simulation.picture(96, 64, location=(0.0, y, -depth), **LOOK)
            return pixels.astype(int)

        near, deep = image(4.0)[30:34], image(12.0)[30:34]
        edges = near[:, :4].mean(axis=(0, 1)), deep[:, :4].mean(axis=(0, 1))
        for red, green, blue in edges:
            assert red < green < blue
        assert edges[1].sum() < 0.8 * edges[0].sum()  # 8 m deeper
        assert np.abs(near[:, 46:50].mean(axis=(0, 1)) - edges[0]).max() > 15  # the crate at 3 m
        far = image(4.0, 10.0)[30:34]  # the other one is 50 m away
        assert np.abs(far[:, 46:50].mean(axis=(0, 1)) - far[:, :4].mean(axis=(0, 1))).max() <= 2


def test_above_the_surface_nothing_changes() -> None:
    def ground() -> None:
        Cube().name = "Waterfall"  # neither flat nor wide
        FakeRobot()
        Environment("empty")

    with morse.load(ground) as simulation:
        assert water_level(simulation.scene) is None
    with morse.load(sea) as simulation:
        above = simulation.picture(96, 64, location=(0.0, 0.0, 1.0), **LOOK)[:20].astype(int)
        assert above.mean() > 100  # a day
