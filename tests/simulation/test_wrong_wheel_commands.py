"""Robots with wheels do not disturb each other by wrong commands."""

import math

import pytest

import morse

COUNT = 4


def scene():
    from morse.builder import Environment, MotionVWDiff, Pioneer3DX, Pose, SegwayRMP400

    for number in range(COUNT):
        robot = Pioneer3DX(f"r{number}") if number % 2 else SegwayRMP400(f"r{number}")
        robot.translate(3.0 * number, 0.0, 0.2)
        robot.append(MotionVWDiff("motion"))
        robot.append(Pose("pose"))
    Environment("empty", fastmode=True)


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
