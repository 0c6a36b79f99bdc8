"""Angles of wheels against the distance that they roll."""

import math

import pytest

from morse.core.kinds import bind

SCRIPT = """
robot = {robot}()
motion = MotionVWDiff()
robot.append(motion)
encoders = WheelEncoders()
{setting}
robot.append(encoders)
pose = Pose()
robot.append(pose)
env = Environment("empty", fastmode=True)
"""
RADIUS, TRACK = 0.0977, 0.342


def driven(simulate, v, w, setting="", robot="Pioneer3DX"):
    simulation = simulate(SCRIPT.format(robot=robot, setting=setting), sockets=False)
    simulation.sleep(0.5)
    start = list(simulation.context.component("robot.encoders").local_data["position"])
    simulation.context.component("robot.motion").local_data.update(v=v, w=w)
    simulation.sleep(2.0)
    return simulation, start


def test_wheels_that_roll_ahead(simulate):
    simulation, start = driven(simulate, 0.5, 0.0)
    data, way = (
        simulation.context.component("robot.encoders").local_data,
        simulation.context.component("robot.pose").local_data["x"],
    )
    assert way == pytest.approx(1.0, abs=0.1)
    assert len(data["wheels"]) == 2
    for before, after in zip(start, data["position"], strict=True):
        assert (after - before) * RADIUS == pytest.approx(way, rel=0.02)
    assert data["velocity"] == pytest.approx([0.5 / RADIUS] * 2, rel=0.05)


def test_wheels_that_turn_a_robot(simulate):
    simulation, _ = driven(simulate, 0.0, 0.5)
    encoders = simulation.context.component("robot.encoders")
    speeds = dict(zip(encoders.local_data["wheels"], encoders.local_data["velocity"], strict=True))
    (left,) = (speed for name, speed in speeds.items() if "left" in name.lower() or name.upper().endswith("L"))
    (right,) = (speed for name, speed in speeds.items() if "right" in name.lower() or name.upper().endswith("R"))
    assert left < 0.0 < right
    assert right == pytest.approx(-left, rel=0.05)


def test_whole_steps(simulate):
    setting = "encoders.properties(StepsPerTurn=16)"
    simulation, _ = driven(simulate, 0.5, 0.0, setting)
    exact, _ = driven(simulate, 0.5, 0.0, "encoders.properties(StepsPerTurn=0)")
    data, angles = (
        simulation.context.component("robot.encoders").local_data,
        exact.context.component("robot.encoders").local_data["position"],
    )
    step = math.tau / 16
    for ticks, position, angle in zip(data["ticks"], data["position"], angles, strict=True):
        assert position == pytest.approx(ticks * step)
        assert 0.0 <= angle - position < step


def test_as_a_message_kind(simulate):
    simulation, _ = driven(simulate, 0.5, 0.0)
    message = bind(simulation.context.component("robot.encoders"))[0].gather()
    assert message.kind.name == "joints"
    assert list(message.names) == simulation.context.component("robot.encoders").local_data["wheels"]
    assert message.velocity == pytest.approx([0.5 / RADIUS] * 2, rel=0.05)


def test_four_wheels(simulate):
    simulation, _ = driven(simulate, 0.5, 0.0, robot="SegwayRMP400")
    assert len(simulation.context.component("robot.encoders").local_data["position"]) == 4


def test_a_robot_without_wheels(simulate):
    with pytest.raises(Exception, match="has no driven wheels: append wheel encoders to a robot whose wheels turn"):
        simulate(SCRIPT.format(robot="ATRV", setting="").replace("MotionVWDiff", "MotionVW"), sockets=False)


def test_they_go_on_from_a_saved_state(simulate):
    simulation, _ = driven(simulate, 0.5, 0.2)
    state = simulation.save()
    simulation.sleep(0.2)
    first = simulation.context.component("robot.encoders").local_data["ticks"][:]
    simulation.restore(state)
    simulation.sleep(0.2)
    assert simulation.context.component("robot.encoders").local_data["ticks"] == first
