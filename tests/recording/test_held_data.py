"""A saved state does not hold the data of sensors, which would have to be filled in every tick from then on."""

from __future__ import annotations

import gc
import sys
from typing import Any

import morse
from morse.builder import ATRV, Environment, Pose


def _scene() -> None:
    for number in range(5):
        robot = ATRV(f"r{number}")
        robot.translate(3.0 * number, 0.0, 0.0)
        robot.append(Pose(f"pose{number}"))
    Environment("empty", fastmode=True)


def test_saving_leaves_no_reference_to_the_data_of_sensors() -> None:
    with morse.load(_scene) as sim:
        sim.step(3)
        group: Any = sim.context.components["r0.pose0"].group  # type: ignore[attr-defined]
        data = group.fill(0)
        gc.disable()
        try:
            before = sys.getrefcount(data)
            state = sim.save()
            assert sys.getrefcount(data) == before
        finally:
            gc.enable()
        assert state.parts
