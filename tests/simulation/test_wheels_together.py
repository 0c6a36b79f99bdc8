"""Robots with wheels that are commanded together move as those that are commanded one by one, to the bit."""

from __future__ import annotations

import math

import pytest

import morse
from morse.actuators.v_omega_diff_drive import MotionVWDiff

COUNT = 4


def scene():
    from morse.builder import Environment, MotionVWDiff, Pioneer3DX, Pose, SegwayRMP400

    for number in range(COUNT):
        robot = Pioneer3DX(f"r{number}") if number % 2 else SegwayRMP400(f"r{number}")
        robot.translate(3.0 * number, 0.0, 0.2)
        robot.append(MotionVWDiff("motion"))
        robot.append(Pose("pose"))
    Environment("empty", fastmode=True)


def driven(simulation):
    """Drive along curves; what the robots did, and the size of the group of their actuators at first and at last."""
    components = simulation.context.components
    sizes, hashes = [], []
    for tick in range(120):
        for number in range(COUNT):
            motion = components[f"r{number}.motion"]
            motion.local_data.update(v=0.5 * math.cos(0.02 * tick), w=0.4 * math.sin(0.03 * tick * number))
        if tick == 40:
            components["r1.motion"].set_property("MaxAcceleration", 0.2)
        simulation.step(1)
        if tick % 39 == 0:
            units = [unit for unit in simulation._ticker._groups if unit._group is not None]
            sizes.append([len(unit._group) for unit in units if isinstance(unit.members[0], MotionVWDiff)])
            hashes.append(simulation.state_hash())
    return sizes, hashes, [components[f"r{number}.pose"].local_data["x"] for number in range(COUNT)]


def test_the_bits_are_the_same(monkeypatch):
    with morse.load(scene) as simulation:
        sizes, together, places = driven(simulation)
    assert sizes[0] == [COUNT]
    assert sizes[-1] == [COUNT - 1], "the robot with a limit acts alone"
    assert all(abs(x - 3.0 * number) > 0.1 for number, x in enumerate(places)), "the robots drive"
    monkeypatch.setenv("MORSE_FLEETS", "off")
    with morse.load(scene) as simulation:
        sizes, alone, _ = driven(simulation)
    assert not any(sizes)
    assert alone == together


@pytest.mark.parametrize("wrong", [math.nan, math.inf, "fast", None])
def test_one_wrong_command_stops_nobody_else(wrong):
    with morse.load(scene) as simulation:
        components = simulation.context.components
        for number in range(COUNT):
            components[f"r{number}.motion"].local_data["v"] = 0.5
        simulation.step(10)
        before = [components[f"r{number}.pose"].local_data["x"] for number in range(COUNT)]
        components["r2.motion"].local_data["v"] = wrong
        # with wheels at full speed, robot 2 meets robot 3 after 0.9 s
        simulation.step(40)
        for number in (0, 1, 3):
            assert components[f"r{number}.pose"].local_data["x"] - before[number] == pytest.approx(0.33, abs=0.1)
