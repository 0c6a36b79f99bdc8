"""A car in a town: the distance that MORSE 1.4 measured, and a start inside the ground."""

import pytest

SCENE = """
robot = Hummer()
robot.translate(z={height})
motion = SteerForce()
robot.append(motion)
robot.append(Pose("pose"))
env = Environment("{world}")
{setting}
"""
CALIBRATED = "env.use_physics_of_1_4()"
#: of the model: distance from the origin to the bottom, m
BOTTOM = 0.98


@pytest.mark.parametrize("brake", [2.0, 10.0, 50.0])
def test_the_distance_for_a_force_and_a_brake(simulate, brake):
    made = simulate(SCENE.format(height=0.0, world="land-1/rosace_1", setting=CALIBRATED), sockets=False)
    made.sleep(0.5)
    made.robot.motion.publish({"steer": 0.0, "force": -20.0, "brake": 0.0})
    made.sleep(3.0)
    made.robot.motion.publish({"steer": 0.0, "force": 0.0, "brake": brake})
    made.sleep(3.0)
    data = made.context.component("robot.pose").local_data
    assert data["x"] == pytest.approx(8.5, abs=1.0)
    assert data["y"] == pytest.approx(0.0, abs=0.1)


def test_two_ways_forward_and_one_back(simulate):
    made = simulate(SCENE.format(height=0.0, world="land-1/rosace_1", setting=CALIBRATED), sockets=False)
    made.sleep(0.5)
    places = []
    for force, brake, seconds in ((-20.0, 0.0, 3.0), (0.0, 10.0, 2.5), (-20.0, 0.0, 5.0), (0.0, 10.0, 2.5)):
        made.robot.motion.publish({"steer": 0.0, "force": force, "brake": brake})
        made.sleep(seconds + 1 / 60)
        places.append(made.context.component("robot.pose").local_data["x"])
    made.robot.motion.publish({"steer": 0.0, "force": 10.0, "brake": 0.0})
    made.sleep(11.0)
    places.append(made.context.component("robot.pose").local_data["x"])
    assert places[1] == pytest.approx(8.5, abs=1.0)
    assert places[3] == pytest.approx(28.0, abs=1.0)
    assert places[4] == pytest.approx(0.0, abs=1.5)


@pytest.mark.parametrize("setting", ["", CALIBRATED], ids=["default", "of_1_4"])
@pytest.mark.parametrize("world", ["empty", "land-1/rosace_1"])
@pytest.mark.parametrize("height", [0.0, 0.3, 0.6])
def test_a_robot_that_starts_inside_the_ground_stands_on_it(simulate, world, height, setting):
    made = simulate(SCENE.format(height=height, world=world, setting=setting), sockets=False)
    made.sleep(1.0)
    data = made.context.component("robot.pose").local_data
    # the ground of the town is not quite level, so that the car rolls slowly
    assert (data["x"], data["y"]) == pytest.approx((0.0, 0.0), abs=0.3)
    assert data["z"] == pytest.approx(BOTTOM, abs=0.05)


# -- the joystick actuator -------------------------------------------------------------------------

JOYSTICK_SCENE = """
robot = Morsy()
joystick = Joystick({arguments})
robot.append(joystick)
joystick.properties(Speed=2.0)
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def deflected(simulate, axes, arguments="", seconds=1.0):
    made = simulate(JOYSTICK_SCENE.format(arguments=arguments), sockets=False)
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


# -- the keyboard actuator -------------------------------------------------------------------------

KEYBOARD_SCENE = """
robot = Morsy()
keyboard = Keyboard()
robot.append(keyboard)
keyboard.properties({properties})
pose = Pose()
robot.append(pose)
env = Environment("empty")
"""


def held(simulate, keys, seconds=1.0, properties="ControlType='Position'"):
    made = simulate(KEYBOARD_SCENE.format(properties=properties), sockets=False)
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
    made = simulate(KEYBOARD_SCENE.format(properties="ControlType='Position'"), sockets=False)
    made.set_controls(frozenset(["ArrowUp"]), (), "another")
    made.sleep(0.5)
    assert made.context.component("robot.pose").local_data["x"] == pytest.approx(0.0, abs=1e-3)
