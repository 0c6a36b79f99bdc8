"""Checks of the recipes that are scenes."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from morse.rosmsgs.remap import Remaps
from morse.rosmsgs.table import Qos


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


def _obstacle(sim: Any) -> None:
    walker = sim.context.component("walker").bge_object
    for time, y in ((2.0, 0.0), (4.0, 2.0), (6.0, 0.0)):
        sim.step(round(time * 60) - round(sim.time() * 60))
        assert walker.worldPosition.y == pytest.approx(y, abs=0.1)


def _by_hand(sim: Any) -> None:
    sim.step(10)
    assert {"robot.keyboard", "other.joystick"} <= sim.context.components.keys()


def _rig(sim: Any) -> None:
    sim.step(2)
    images = [np.asarray(getattr(sim.robot, name).get()["image"]) for name in ("front", "left", "back", "right")]
    assert all(image.std() > 10.0 for image in images)
    assert all(np.any(one != other) for one, other in pairwise(images))


def _labels(sim: Any) -> None:
    sim.step(2)
    image = np.asarray(sim.robot.camera.get()["image"])
    assert len(np.unique(image)) >= 4  # three crates, and what is no object


def _remapped(sim: Any) -> None:
    (options,) = sim.scene.manager_options.values()
    remaps, qos = Remaps(options["remap"]), Qos()
    assert remaps.apply("/robot/laser", qos) == ("/scan", qos)
    assert remaps.apply("/robot/motion", qos) == ("/cmd_vel", qos)
    assert not list(remaps.unused())


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
    "A moving obstacle": _obstacle,
    "Drive by hand": _by_hand,
    "Four cameras on one robot": _rig,
    "Which pixel shows which object?": _labels,
    "Other names in ROS 2": _remapped,
}
