"""Driven robots with the physics of MORSE 1.4. The values are measurements of 1.4, with the tolerances of its tests."""

import math

import pytest

SCENE = """
robot = {robot}()
{extra}
motion = {motion}()
robot.append(motion)
for sensor in (Pose("pose"), Velocity("velocity"), Airspeed("airspeed"), GPS("gps")):
    robot.append(sensor)
env = Environment("empty")
{setting}
"""
G = 9.81


@pytest.fixture
def drive(simulate):
    def at_rest(robot, motion, extra="", setting="env.use_physics_of_1_4()"):
        made = simulate(SCENE.format(robot=robot, motion=motion, extra=extra, setting=setting), sockets=False)
        made.sleep(1.0)
        return made

    return at_rest


def place(made):
    pose = made.context.component("robot.pose").local_data
    return pose["x"], pose["y"], pose["yaw"]


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0, -1.0])
@pytest.mark.parametrize(("robot", "damping"), [("Morsy", 0.493), ("ATRV", 0.025)])
def test_the_speed_at_the_end_of_a_tick_and_its_mean(drive, robot, damping, speed):
    made = drive(robot, "MotionXYW")
    made.robot.motion.publish({"x": 0.0, "y": speed, "w": 0.0})
    made.sleep(1.0)
    begin = place(made)[1]
    made.sleep(1.0)
    lost = 0.25 * G / 60
    expected = math.copysign(abs(speed) * (1 - damping) ** (1 / 60) - lost, speed)
    assert made.context.component("robot.velocity").local_data["linear_velocity"][1] == pytest.approx(
        expected, abs=0.002
    )
    mean = speed - 0.75 * (speed - expected)
    assert place(made)[1] - begin == pytest.approx(mean, abs=0.003)


@pytest.mark.parametrize(("speed", "pressure"), [(1.0, 0.55), (2.0, 2.30)])
def test_an_airspeed_sensor_measures_the_speed_at_the_end_of_a_tick(drive, speed, pressure):
    made = drive("Morsy", "MotionXYW")
    made.robot.motion.publish({"x": speed, "y": 0.0, "w": 0.0})
    made.sleep(1.0)
    assert made.context.component("robot.airspeed").local_data["diff_pressure"] == pytest.approx(pressure, abs=0.01)


@pytest.mark.parametrize(
    ("friction", "distance"), [(None, 2.05 * 2.0 / 2.1), (0.0, 2.0), (5.0, 1.4)], ids=["none", "smooth", "rough"]
)
def test_the_distance_for_a_friction(drive, friction, distance):
    made = drive("ATRV", "MotionVW", "" if friction is None else f"robot.set_friction({friction})")
    made.robot.motion.publish({"v": 1.0, "w": 0.0})
    made.sleep(2.0)
    assert place(made)[0] == pytest.approx(distance, abs=0.03)


def test_a_circle_of_two_arcs_ends_where_it_began(drive):
    made = drive("ATRV", "MotionVW")
    for v, w, seconds in ((1.0, -math.pi / 4, 2.1), (0.5, -math.pi / 8, 12.1)):
        made.robot.motion.publish({"v": v, "w": w})
        made.sleep(seconds)
    x, y, yaw = place(made)
    assert (x, y, math.remainder(yaw, 2 * math.pi)) == pytest.approx((0.0, 0.0, 0.0), abs=0.1)


def test_three_quarters_of_a_circle_backwards(drive):
    made = drive("ATRV", "MotionVW")
    made.robot.motion.publish({"v": -2.0, "w": math.pi / 2})
    made.sleep(3.1)
    radius = 4.0 / math.pi
    assert place(made) == pytest.approx((radius, -radius, -math.pi / 2), abs=0.2)


def test_a_robot_without_a_command_rolls_out(drive):
    made = drive("ATRV", "MotionVW")
    made.robot.motion.publish({"v": 1.0, "w": 0.0})
    made.sleep(1.0)
    made.context.component("robot.motion").active = False
    begin = place(made)[0]
    made.sleep(1.0)
    speed = (0.975) ** (1 / 60) - 0.25 * G / 60
    assert place(made)[0] - begin == pytest.approx(speed**2 / (2 * 2.45), abs=0.03)


def test_by_default_a_robot_has_exactly_its_commanded_speed(drive):
    made = drive("Morsy", "MotionXYW", setting="env.use_physics_of_1_4(False)")
    made.robot.motion.publish({"x": 1.0, "y": 0.0, "w": 0.0})
    made.sleep(1.0)
    assert made.context.component("robot.velocity").local_data["linear_velocity"][0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("setting", "latitude"), [("env.use_physics_of_1_4()", 43.5999985), ("", 43.6)])
def test_the_origin_on_the_earth_has_single_precision(drive, setting, latitude):
    made = drive("FakeRobot", "MotionXYW", setting=f"env.properties(longitude=1.4, latitude=43.6)\n{setting}")
    assert made.scene.properties["latitude"] == pytest.approx(latitude, abs=1e-7)


def test_four_wheels_turn_a_little_less(drive):
    made = drive("SegwayRMP400", "MotionVWDiff")
    made.robot.motion.publish({"v": 1.0, "w": -math.pi / 4})
    made.sleep(1.0)
    begin = place(made)[2]
    made.sleep(1.0)
    assert 0.97 < (begin - place(made)[2]) / (math.pi / 4) < 0.99


def test_a_force_at_the_origin_does_not_turn_a_robot(simulate):
    made = simulate(
        """
robot = ATRV()
robot.translate(z=10.0)
robot._bpy_object.game.lock_location_z = True
push = ForceTorque()
robot.append(push)
for sensor in (Pose("pose"), Velocity("velocity"), Accelerometer("accelerometer")):
    robot.append(sensor)
env = Environment("empty")
env.use_physics_of_1_4()
""",
        sockets=False,
    )
    measured = []
    for force in (100.0, 100.0, 0.0):
        made.robot.push.publish({"force": [force, 0.0, 0.0], "torque": [0.0, 0.0, 0.0]})
        made.sleep(1.0)
        speed = made.context.component("robot.velocity").local_data["linear_velocity"][0]
        measured.append((speed, made.context.component("robot.accelerometer").local_data["acceleration"][0]))
    # as measured in 1.4, with 100 N on 20 kg
    expected = [(5.0, 4.8), (10.0, 4.8), (9.8, -0.2)]
    assert measured == [pytest.approx(pair, abs=0.2) for pair in expected]
    pose = made.context.component("robot.pose").local_data
    assert (pose["pitch"], pose["roll"]) == pytest.approx((0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize(("axis", "direction", "angle"), [(0, 1.0, "theta_c"), (1, -1.0, "phi_c")])
def test_a_stabilized_quadrotor_in_rounds_of_62_ticks(simulate, axis, direction, angle):
    made = simulate(
        """
robot = Quadrotor()
motion = StabilizedQuadrotor()
robot.append(motion)
robot.append(Pose("pose"))
env = Environment("empty")
env.use_physics_of_1_4()
""",
        sockets=False,
    )
    level = {"theta_c": 0.0, "phi_c": 0.0, "psi_c": 0.0, "h_c": 0.0}
    made.step(10)
    for given, distance in ((0.1, 0.4), (0.1, 1.8), (0.0, 4.0), (0.0, 6.2)):
        made.robot.motion.publish({**level, angle: given})
        # a client that publishes, sleeps for a second and waits for a message
        made.step(62)
        assert place(made)[axis] == pytest.approx(direction * distance, abs=0.2)


def test_a_robot_turns_about_several_axes_at_the_commanded_rates(simulate):
    made = simulate(
        """
robot = Quadrotor()
robot.translate(z=10.0)
motion = Orientation()
motion.properties(speed=0.5)
robot.append(motion)
robot.append(Attitude("attitude"))
env = Environment("empty")
env.set_gravity(0.0)
env.use_physics_of_1_4()
""",
        sockets=False,
    )
    made.robot.motion.publish({"yaw": 2.0, "pitch": 0.0, "roll": 0.0})
    made.sleep(6.0)
    made.robot.motion.publish({"yaw": 3.0, "pitch": 1.0, "roll": 0.0})
    # a client that sleeps for half a second measures in tick 32, between two corrections of the roll
    made.step(30)
    for _ in range(3):
        made.step(1)
        rates = made.context.component("robot.attitude").local_data["angular_velocity"]
        assert list(rates) == pytest.approx([0.0, 0.5, 0.5], abs=0.003)
