"""The keyboard actuator."""

import pytest

SCENE = """
robot = Morsy()
keyboard = Keyboard()
robot.append(keyboard)
keyboard.properties({properties})
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def held(simulate, keys, seconds=1.0, properties="ControlType='Position'"):
    made = simulate(SCENE.format(properties=properties), sockets=False)
    made.sleep(0.3)
    made.set_controls(frozenset(keys))
    made.sleep(seconds)
    return made


@pytest.mark.parametrize(
    ("keys", "field", "value"),
    [
        (["ArrowUp"], "x", 1.0),
        (["ArrowDown"], "x", -1.0),
        (["KeyU"], "y", 1.0),
        (["KeyO"], "y", -1.0),
        (["ArrowLeft"], "yaw", 0.5),
        (["ArrowRight"], "yaw", -0.5),
        (["ArrowUp", "ArrowDown"], "x", 0.0),
        (["KeyQ"], "x", 0.0),
    ],
)
def test_each_key_moves_its_axis(simulate, keys, field, value):
    made = held(simulate, keys)
    assert made.context.component("robot.pose").local_data[field] == pytest.approx(value, abs=0.02)


def test_chords_drive_and_turn(simulate):
    data = held(simulate, ["ArrowUp", "ArrowLeft"]).context.component("robot.pose").local_data
    assert data["yaw"] == pytest.approx(0.5, abs=0.02)
    assert 0.9 < data["x"] < 1.0
    assert data["y"] == pytest.approx(2 * (1 - 0.8776), abs=0.02)  # v/w (1 - cos 0.5)


def test_the_speed_is_a_property(simulate):
    data = (
        held(simulate, ["ArrowUp"], properties="ControlType='Velocity', Speed=2.0")
        .context.component("robot.pose")
        .local_data
    )
    assert data["x"] == pytest.approx(2.0, abs=0.03)


def test_released_keys_stop_the_robot(simulate):
    made = held(simulate, ["ArrowUp"], properties="ControlType='Velocity'")
    made.set_controls(frozenset())
    made.sleep(0.5)
    stopped = made.context.component("robot.pose").local_data["x"]
    made.sleep(1.0)
    assert made.context.component("robot.pose").local_data["x"] == pytest.approx(stopped, abs=5e-3)


def test_the_zero_is_sent_once_so_that_others_may_drive(simulate):
    made = held(simulate, ["ArrowUp"], seconds=0.2)
    made.set_controls(frozenset())
    made.sleep(0.2)
    calls = []
    made.context.component("robot").apply_speed = lambda *arguments: calls.append(arguments)
    made.sleep(0.2)
    assert calls == []


def test_keys_drive_the_robot_that_listens(simulate):
    made = simulate(SCENE.format(properties="ControlType='Position'"), sockets=False)
    made.set_controls(frozenset(["ArrowUp"]), (), "another")
    made.sleep(0.5)
    assert made.context.component("robot.pose").local_data["x"] == pytest.approx(0.0, abs=1e-3)
