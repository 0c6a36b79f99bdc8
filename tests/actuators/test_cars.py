"""Cars: circles from wheelbase and steering angle, acceleration from force and mass."""

import math

import pytest

HUMMER = """
robot = Hummer()
robot.translate(0, 0, 1.0)
motion = SteerForce()
robot.append(motion)
pose = Pose()
robot.append(pose)
"""
#: of the model: front axle 1.6 m ahead of the origin, rear axle 2.3 m behind; 10 kg
WHEELBASE, REAR, MASS = 3.9, 2.3, 10.0


def load(simulate, scene=HUMMER):
    sim = simulate(scene, sockets=False)
    sim.step(60)
    return sim


def place(sim):
    data = sim.robot.pose.get()
    return data["x"], data["y"], data["yaw"]


def test_it_accelerates_by_force_over_mass_and_forward_is_negative(simulate):
    sim = load(simulate)
    x, y, _ = place(sim)
    sim.robot.motion.publish({"force": -5.0})
    sim.step(120)
    # four wheels, each 0.4 of the force; the model drives along its Y axis, which is X of the world
    a = 4 * 0.4 * 5.0 / MASS
    there = place(sim)
    assert there[0] - x == pytest.approx(0.5 * a * 2.0**2, rel=0.05)
    assert there[1] == pytest.approx(y, abs=0.01)


def test_the_brake_stops_it_in_the_distance_of_its_force(simulate):
    sim = load(simulate)
    sim.robot.motion.publish({"force": -10.0})
    sim.step(120)
    body = sim.context.component("robot").bge_object
    v = body.worldLinearVelocity.length
    assert v == pytest.approx(2.0 * 1.6, rel=0.05)
    begun = place(sim)[0]
    v = body.worldLinearVelocity.length
    sim.robot.motion.publish({"force": 0.0, "brake": 10.0})
    sim.step(240)
    stopped = place(sim)[0]
    a = (2 * 0.1 + 2 * 1.3) * 10.0 / MASS
    assert stopped - begun == pytest.approx(v * v / (2 * a), abs=0.15)
    sim.step(60)
    assert place(sim)[0] == pytest.approx(stopped, abs=1e-3)


@pytest.mark.parametrize("steer", [0.3, -0.5])
def test_the_rear_axle_drives_a_circle_of_the_wheelbase_over_the_tangent(simulate, steer):
    sim = load(simulate)
    sim.robot.motion.publish({"force": -10.0})
    sim.step(60)
    sim.robot.motion.publish({"force": 0.0, "steer": steer})
    sim.step(30)
    points = []
    for _ in range(3):
        x, y, yaw = place(sim)
        heading = yaw + math.pi / 2
        points.append((x - REAR * math.cos(heading), y - REAR * math.sin(heading), heading))
        sim.step(60)
    radius = WHEELBASE / math.tan(steer)
    centres = [(x - radius * math.sin(h), y + radius * math.cos(h)) for x, y, h in points]
    assert centres[1] == pytest.approx(centres[0], abs=0.06)
    assert centres[2] == pytest.approx(centres[0], abs=0.06)


def test_the_front_wheels_point_across_the_lines_to_the_centre(simulate):
    sim = load(simulate)
    sim.robot.motion.publish({"steer": 0.4})
    sim.step(2)
    body = sim.context.component("robot").bge_object
    radius = WHEELBASE / math.tan(0.4)
    for name, left in (("wheel1", 1.3), ("wheel2", -1.3)):
        wheel = next(part for part in body.children if part.node.plain_name == name)
        r = wheel.localOrientation
        assert math.atan2(r[1][0], r[0][0]) == pytest.approx(math.atan(WHEELBASE / (radius - left)), abs=1e-6)


def test_a_robot_without_wheels_cannot_be_steered(simulate):
    with pytest.raises(Exception, match=r"no front and rear wheels.*Hummer"):
        simulate("robot = Morsy()\nmotion = SteerForce()\nrobot.append(motion)", sockets=False)


CAR = HUMMER.replace("SteerForce", "MotionVW").replace(
    "motion =", "robot.properties(classpath='morse.core.wheeled_robot.PhysicsAckermannRobot')\nmotion ="
)


def test_an_ackermann_robot_follows_speed_and_yaw_rate(simulate):
    sim = load(simulate, CAR)
    robot = sim.context.component("robot")
    assert robot.steering.wheelbase == pytest.approx(WHEELBASE, abs=1e-3)
    assert robot.steering.track == pytest.approx(2.6, abs=1e-3)
    sim.robot.motion.publish({"v": 2.0, "w": 0.3})
    sim.step(60 * 12)
    assert robot.steering.speed() == pytest.approx(2.0, abs=0.05)
    assert robot.steering.yaw_rate() == pytest.approx(0.3, abs=0.02)


def test_it_turns_no_tighter_than_its_wheels_do_and_not_on_the_spot(simulate):
    sim = load(simulate, CAR.replace("robot.properties(", "robot.properties(max_steering_angle=20.0, "))
    robot = sim.context.component("robot")
    sim.robot.motion.publish({"v": 1.0, "w": 2.0})
    sim.step(60 * 12)
    speed = robot.steering.speed()
    assert robot.steering.yaw_rate() == pytest.approx(speed * math.tan(math.radians(20.0)) / WHEELBASE, rel=0.03)
    sim.robot.motion.publish({"v": 0.0, "w": 2.0})
    sim.step(60 * 12)
    yaw = place(sim)[2]
    sim.step(60)
    assert place(sim)[2] == pytest.approx(yaw, abs=0.02)


@pytest.mark.parametrize("scene", [HUMMER, CAR])
def test_saved_on_its_way_it_goes_on_to_the_bit(simulate, scene):
    sim = load(simulate, scene)
    sim.robot.motion.publish({"force": -8.0, "steer": 0.2} if scene is HUMMER else {"v": 1.5, "w": 0.2})
    sim.step(60)
    state = sim.save()
    sim.step(60)
    expected, hashed = place(sim), sim.save()
    sim.step(10)
    sim.restore(state)
    sim.step(60)
    assert place(sim) == expected
    assert sim.save() == hashed


# -- actuators of users drive their robot by ``apply_speed``, as those of 1.4 do -------------------

SCENE = """
robot = ATRV()
robot.rotate(z=1.5707963267948966)
own = Light()
robot.append(own)
pose = Pose()
robot.append(pose)
"""


@pytest.mark.parametrize("kind", ["Position", "Velocity"])
def test_an_actuator_drives_its_robot_along_the_axes_of_the_robot(simulate, kind):
    sim = simulate(SCENE, sockets=False)
    actuator = sim.context.component("robot.own")
    for _ in range(60):
        actuator.apply_speed(kind, [0.5, 0.0, 0.0], [0.0, 0.0, 0.2])
        sim.step()
    pose = sim.robot.pose.data
    # an arc of 0.5 m with a radius of 2.5 m, to the left of a robot that faces Y
    assert [pose["x"], pose["y"]] == pytest.approx([-2.5 * (1 - math.cos(0.2)), 2.5 * math.sin(0.2)], abs=0.01)
    assert pose["yaw"] == pytest.approx(math.pi / 2 + 0.2, abs=0.01)
