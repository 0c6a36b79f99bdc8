"""The recipes do what they say."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from doc_pages import DOCS

import morse

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PAGE = (DOCS / "recipes.md").read_text(encoding="utf-8")
RECIPES = dict(re.findall(r"^## (.*?)\n.*?```python\n(.*?)```", PAGE, re.DOTALL | re.MULTILINE))


def _down(sim: Any) -> None:
    sim.step(30)
    image = np.asarray(sim.drone.camera.get()["image"]).astype(int)
    height, width = image.shape[:2]
    red, green, _ = image[height // 2, width // 2, :3]
    assert red > 2 * green


def _circle(sim: Any) -> None:
    sim.step(30)
    for number in range(8):
        pose = getattr(sim, f"scout{number}").pose.get()
        assert math.hypot(pose["x"], pose["y"]) == pytest.approx(3.0, abs=0.05)


def _wall(sim: Any) -> None:
    sim.step(30)
    ranges = sim.robot.laser.get()["range_list"]
    assert 3.0 < ranges[len(ranges) // 2] < 5.0
    assert ranges[0] > 20.0


def _errors(sim: Any) -> None:
    errors = []
    for _ in range(400):
        sim.step(1)
        errors.append(sim.robot.measured.get()["x"] - sim.robot.truth.get()["x"])
    # the standard deviation of 400 samples is within 4 of its own standard deviations, 0.2 / sqrt(800)
    assert np.std(errors) == pytest.approx(0.2, abs=4 * 0.2 / math.sqrt(800))


def _earth(sim: Any) -> None:
    sim.step(30)
    position = sim.robot.gps.get()
    assert position["longitude"] == pytest.approx(11.58, abs=1e-4)
    assert position["latitude"] == pytest.approx(48.14, abs=1e-4)


def _night(sim: Any) -> None:
    sim.step(2)
    night = sim.picture(160, 100).astype(float)
    assert night.max() > 2 * night.mean()  # the cone of the lamp


def _battery(sim: Any) -> None:
    sim.step(120)
    assert sim.robot.battery.get()["charge"] == pytest.approx(90.0, abs=0.5)


def _bend(sim: Any) -> None:
    sim.robot.motion.publish({"v": 1.0, "w": 0.5})
    sim.step(180)
    across = sim.robot.accelerometer.get()["acceleration"][1]
    assert across == pytest.approx(1.0 * 0.5, abs=0.1)


def _recognises(sim: Any) -> None:
    sim.step(30)
    assert [seen["name"] for seen in sim.robot.camera.get()["visible_objects"]] == ["crate"]


CHECKS: dict[str, Callable[[Any], None]] = {
    "A camera that looks down": _down,
    "Robots in a circle": _circle,
    "Distances to a wall": _wall,
    "A sensor with errors": _errors,
    "A position on the Earth": _earth,
    "A lamp in the night": _night,
    "A battery that runs down": _battery,
    "The force in a bend": _bend,
    "See what a robot recognises": _recognises,
}


def test_every_recipe_is_checked_and_short() -> None:
    assert CHECKS.keys() == RECIPES.keys()
    assert max(len(text.splitlines()) for text in RECIPES.values()) <= 14
    for file in re.findall(r"\((pictures/recipes/.*?)\)", PAGE):
        assert (DOCS / file).is_file()


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_does_what_it_says(name: str, tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(RECIPES[name], encoding="utf-8")
    with morse.load(script) as sim:
        CHECKS[name](sim)
