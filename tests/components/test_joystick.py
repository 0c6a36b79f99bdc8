"""The joystick actuator."""

import pytest

SCENE = """
robot = Morsy()
joystick = Joystick({arguments})
robot.append(joystick)
joystick.properties(Speed=2.0)
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def deflected(simulate, axes, arguments="", seconds=1.0):
    made = simulate(SCENE.format(arguments=arguments), sockets=False)
    made.sleep(0.3)
    made.set_controls(frozenset(), tuple(axes))
    made.sleep(seconds)
    return made.context.component("robot.pose").local_data


def test_pushing_the_stick_drives_forward(simulate):
    # up is negative on a gamepad
    assert deflected(simulate, (0.0, -1.0))["x"] == pytest.approx(2.0, abs=0.03)


def test_moving_it_to_the_right_turns_right(simulate):
    assert deflected(simulate, (0.5, 0.0))["yaw"] == pytest.approx(-2.0 * (0.5 - 0.08) / 0.92, abs=0.03)


@pytest.mark.parametrize("axes", [(), (0.0,), (0.05, -0.05)])
def test_without_a_stick_or_with_one_at_rest_nothing_moves(simulate, axes):
    data = deflected(simulate, axes)
    assert (data["x"], data["y"], data["yaw"]) == pytest.approx((0, 0, 0), abs=1e-3)


def test_another_stick_can_be_chosen(simulate):
    assert deflected(simulate, (0.0, -1.0, 0.0, 0.0), "index=1")["x"] == pytest.approx(0.0, abs=1e-3)
    assert deflected(simulate, (0.0, 0.0, 0.0, -1.0), "index=1")["x"] == pytest.approx(2.0, abs=0.03)
