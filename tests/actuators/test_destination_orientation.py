"""Actuators that move a robot to a target on a straight line, and that turn it."""

import math

import pytest

SCENE = """
robot = {robot}()
robot.translate(1.0, 2.0, {z})
robot.rotate(0, 0, {yaw})
motion = {motion}
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


def load(simulate, motion, robot="Morsy", z=0.0, yaw=0.0):
    sim = simulate(SCENE.format(robot=robot, motion=motion, z=z, yaw=yaw), sockets=False)
    sim.step(30)
    return sim


def pose(sim):
    return sim.robot.pose.get()


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_destination_goes_straight_at_its_speed_without_turning(simulate, yaw):
    sim = load(simulate, "Destination(); motion.properties(Speed=1.0, Tolerance=0.1)", yaw=yaw)
    sim.robot.motion.publish({"x": 1.0 - 3.0, "y": 2.0 + 4.0})
    sim.step(121)
    data = pose(sim)
    # 2 of 5 m
    assert (data["x"], data["y"]) == pytest.approx((1.0 - 1.2, 2.0 + 1.6), abs=0.03)
    assert data["yaw"] == pytest.approx(yaw, abs=1e-3)
    sim.step(300)
    data = pose(sim)
    assert math.dist((data["x"], data["y"]), (-2.0, 6.0)) <= 0.12
    assert sim.context.component("robot").move_status == "Arrived"


def test_destination_in_three_dimensions(simulate):
    sim = load(simulate, "Destination(); motion.properties(RemainAtDestination=True)", robot="RMax", z=5.0)
    sim.robot.motion.publish({"x": 4.0, "y": 2.0, "z": 9.0})
    sim.step(120)
    data = pose(sim)
    # 5 m, on a line, up to 0.5 m before the end
    assert (data["x"], data["y"], data["z"]) == pytest.approx((4.0 - 0.3, 2.0, 9.0 - 0.4), abs=0.1)


def test_destination_stays_where_it_is_until_it_is_told(simulate):
    sim = load(simulate, "Destination()")
    data = pose(sim)
    assert (data["x"], data["y"]) == pytest.approx((1.0, 2.0), abs=1e-3)


def test_remaining_at_the_destination_a_push_is_withstood(simulate):
    def pushed(remain):
        motion = f"Destination(); motion.properties(RemainAtDestination={remain})"
        sim = simulate(
            SCENE.format(robot="RMax", motion=motion, z=5.0, yaw=0.0) + "wind = ExternalForce()\nrobot.append(wind)",
            sockets=False,
        )
        sim.step(30)
        sim.robot.wind.publish({"force": [0.2, 0.0, 0.0]})
        sim.step(60)
        return pose(sim)["x"] - 1.0

    # half of 0.2 m/s^2 for a second, for the robot of 1 kg
    assert pushed(False) == pytest.approx(0.1, abs=0.02)
    assert pushed(True) == pytest.approx(0.0, abs=0.01)


def test_orientation_at_once(simulate):
    sim = load(simulate, "Orientation()", robot="RMax", z=5.0)
    sim.robot.motion.publish({"yaw": 1.0, "pitch": -0.4, "roll": 0.2})
    sim.step(2)
    data = pose(sim)
    assert (data["yaw"], data["pitch"], data["roll"]) == pytest.approx((1.0, -0.4, 0.2), abs=1e-6)
    assert (data["x"], data["y"], data["z"]) == pytest.approx((1.0, 2.0, 5.0), abs=1e-6)


def test_orientation_at_once_leaves_a_fall_to_gravity(simulate):
    sim = simulate(SCENE.format(robot="Quadrotor", motion="Orientation()", z=20.0, yaw=0.0), sockets=False)
    sim.robot.motion.publish({"roll": 0.5})
    sim.step(60)
    data = pose(sim)
    assert data["roll"] == pytest.approx(0.5, abs=1e-3)
    # with a small damping
    assert 20.0 - data["z"] == pytest.approx(9.81 / 2.0, rel=0.1)


@pytest.mark.parametrize("control", ["Velocity", "Position"])
def test_orientation_at_a_speed_turns_about_each_axis_by_it(simulate, control):
    motion = f"Orientation(); motion.properties(speed=0.5, ControlType='{control}')"
    sim = load(simulate, motion, robot="RMax", z=5.0)
    sim.robot.motion.publish({"yaw": 1.0, "pitch": 1.0, "roll": 0.0})
    sim.step(6)
    if control == "Velocity":
        rates = sim.context.world.game_object("robot").localAngularVelocity
        assert list(rates) == pytest.approx([0.0, 0.5, 0.5], abs=0.003)
    sim.robot.motion.publish({"yaw": 1.0, "pitch": 0.3, "roll": -0.2})
    sim.step(240)
    data = pose(sim)
    assert (data["yaw"], data["pitch"], data["roll"]) == pytest.approx((1.0, 0.3, -0.2), abs=0.03)


def test_orientation_takes_the_shorter_way(simulate):
    sim = load(simulate, "Orientation(); motion.properties(speed=0.5)", robot="RMax", z=5.0, yaw=3.0)
    sim.robot.motion.publish({"yaw": -3.0})
    sim.step(20)
    assert pose(sim)["yaw"] == pytest.approx(3.0 + 0.5 * 19 / 60, abs=0.02) or pose(sim)["yaw"] < -3.0
    sim.step(30)
    assert math.remainder(pose(sim)["yaw"] + 3.0, 2 * math.pi) == pytest.approx(0.0, abs=0.021)


def test_a_robot_that_goes_to_a_destination_glides(simulate):
    sim = load(simulate, "Destination(); motion.properties(Speed=1.0)", yaw=0.7)
    # the goal is above the robot: the vertical speed of a ground robot is left to the ground
    sim.robot.motion.publish({"x": 6.0, "y": 2.0, "z": 0.5})
    sim.step(60)
    assert sim.context.world.gliding.glides
    data = pose(sim)
    # 1 m/s along a line that rises by 0.5 m in 5 m
    assert data["x"] - 1.0 == pytest.approx(math.cos(math.atan2(0.5, 5.0)), abs=0.02)
    assert data["y"] == pytest.approx(2.0, abs=1e-3)
    assert data["z"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("robot", ["RMax", "Quadrotor", "Submarine"])
def test_a_commanded_angular_velocity_stays_as_it_is_commanded(simulate, robot):
    # also about an axis that is not a principal one, where a free body would tumble
    sim = load(simulate, "Orientation(); motion.properties(speed=0.5)", robot=robot, z=5.0)
    sim.robot.motion.publish({"yaw": 1.5, "pitch": 1.2, "roll": 1.5})
    for _ in range(30):
        sim.step(1)
        rates = sim.context.world.game_object("robot").localAngularVelocity
        assert list(rates) == pytest.approx([0.5, 0.5, 0.5], abs=0.003)


# -- robots without ground contact have their centre of mass at their origin, as in 1.4, where Bullet puts it

TURNING_ABOUT_THE_ORIGIN_SCENE = """
robot = RMax()
robot.translate(10, 8, 20)
robot._bpy_object.game.damping = 0.5
motion = ForceTorque()
robot.append(motion)
pose = Pose()
robot.append(pose)
"""


def test_neither_force_nor_damping_turns_a_robot_that_is_pushed(simulate):
    sim = simulate(TURNING_ABOUT_THE_ORIGIN_SCENE, sockets=False)
    sim.robot.motion.publish({"force": [2.0, 0.0, 0.0]})
    sim.step(120)
    # 1 kg that loses half of its velocity per second: x'' = 2 - ln(2) x'
    rate = math.log(2.0)
    away = 2.0 / rate * (2.0 - (1.0 - math.exp(-2.0 * rate)) / rate)
    pose = sim.robot.pose.data
    assert pose["x"] == pytest.approx(10.0 + away, abs=0.03)
    assert [pose[name] for name in ("y", "z", "yaw", "pitch", "roll")] == pytest.approx([8.0, 20.0, 0, 0, 0], abs=1e-6)


def test_a_torque_turns_a_robot_on_the_spot(simulate):
    sim = simulate(TURNING_ABOUT_THE_ORIGIN_SCENE, sockets=False)
    sim.robot.motion.publish({"torque": [0.0, 0.0, 0.5]})
    sim.step(60)
    pose = sim.robot.pose.data
    assert pose["yaw"] > 0.1
    assert [pose[name] for name in ("x", "y", "z")] == pytest.approx([10.0, 8.0, 20.0], abs=1e-6)


BARE = """
robot = Robot()
body = Cube("body")
body.scale = (0.5, 0.5, 0.5)
body.translate(x={x}, z=0.3)
robot.append(body)
robot.set_rigid_body()
robot.set_collision_bounds()
body._bpy_object.game.physics_type = "STATIC"
"""


@pytest.mark.parametrize(("x", "centre"), [(0.2, (0.0, 0.0, 0.0)), (2.0, (2.0, 0.0, 0.0))])
def test_an_origin_outside_the_body_is_no_centre_of_mass(simulate, x, centre):
    sim = simulate(BARE.format(x=x), sockets=False)
    found = {name: place for name, _, place in sim.context.world.mass_centres()}["robot"]
    assert found == pytest.approx(centre, abs=1e-6)
