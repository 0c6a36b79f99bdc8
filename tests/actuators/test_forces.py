"""Forces and drag against closed forms."""

import math

import pytest

# RMax has no gravity and a mass of 1 kg; without damping
SCENE = """
robot = RMax()
robot.translate(0, 0, 50)
robot._bpy_object.game.damping = 0.0
robot._bpy_object.game.rotation_damping = 0.0
{more}
pose = Pose()
robot.append(pose)
"""


def load(simulate, more):
    return simulate(SCENE.format(more=more), sockets=False)


def body(sim):
    return sim.context.component("robot").bge_object


def test_a_force_accelerates_by_its_share_of_the_mass(simulate):
    sim = load(simulate, "motion = ForceTorque()\nrobot.append(motion)")
    sim.robot.motion.publish({"force": [0.6, 0.0, -0.3]})
    sim.step(60)
    assert body(sim).worldLinearVelocity[:] == pytest.approx((0.6, 0.0, -0.3), abs=0.02)
    sim.robot.motion.publish({"force": [0.0, 0.0, 0.0]})
    sim.step(60)
    assert body(sim).worldLinearVelocity[:] == pytest.approx((0.6, 0.0, -0.3), abs=0.02)


def test_a_torque_turns_by_its_share_of_the_inertia(simulate):
    sim = load(simulate, "motion = ForceTorque()\nrobot.append(motion)")
    inertia = body(sim).localInertia[2]
    sim.robot.motion.publish({"torque": [0.0, 0.0, 0.2]})
    sim.step(60)
    assert body(sim).worldAngularVelocity[2] == pytest.approx(0.2 / inertia, rel=0.03)


def test_a_force_beside_the_origin_turns_the_robot(simulate):
    more = "motion = ForceTorque()\nmotion.translate(0, 0.5, 0)\nmotion.rotate(0, 0, 1.5707963)\nrobot.append(motion)"
    sim = load(simulate, more)
    inertia = body(sim).localInertia[2]
    # along Y of the actuator, which is -X of the robot, 0.5 m to the left: the torque turns the nose to the left
    sim.robot.motion.publish({"force": [0.0, 0.1, 0.0]})
    sim.step(30)
    assert body(sim).worldAngularVelocity[2] == pytest.approx(0.5 * 0.1 / inertia * 0.5, rel=0.05)
    assert body(sim).worldLinearVelocity[0] < -0.04


def test_in_the_frame_of_the_robot_the_place_does_not_matter(simulate):
    more = (
        "motion = ForceTorque()\nmotion.translate(0, 0.5, 0)\nmotion.rotate(0, 0, 1.5707963)\n"
        "motion.properties(RobotFrame=True)\nrobot.append(motion)"
    )
    sim = load(simulate, more)
    sim.robot.motion.publish({"force": [0.5, 0.0, 0.0]})
    sim.step(60)
    assert body(sim).worldAngularVelocity.length == pytest.approx(0.0, abs=1e-9)
    assert body(sim).worldLinearVelocity[0] == pytest.approx(0.5, abs=0.02)


#: in any attitude, the axes of the world are meant
TURNS = {"level": (0.0, 0.0, 0.0), "heading": (0.0, 0.0, 2.0), "upside down": (3.0, 0.4, -1.0)}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
@pytest.mark.parametrize("mass", [1.0, 4.0])
def test_wind_accelerates_by_its_share_of_the_mass_along_the_axes_of_the_world(simulate, turn, mass):
    more = f"robot.set_mass({mass})\nrobot.rotate{turn}\nwind = ExternalForce()\nwind.translate(0.3, -0.2, 0.5)"
    sim = load(simulate, more + "\nwind.rotate(0, 0, 1.0)\nrobot.append(wind)")
    sim.step(2)
    start = body(sim).worldPosition[:]
    force = (0.5, 0.25, -0.75)
    sim.robot.wind.publish({"force": force})
    sim.step(60)
    # v = F t / m and s = F t^2 / 2 m, wherever the actuator is and however it is turned
    assert body(sim).worldLinearVelocity[:] == pytest.approx([part / mass for part in force], rel=1e-6)
    way = [b - a for a, b in zip(start, body(sim).worldPosition[:], strict=True)]
    assert way == pytest.approx([part / mass / 2.0 for part in force], rel=0.01)
    assert body(sim).worldAngularVelocity.length == pytest.approx(0.0, abs=1e-9)
    sim.robot.wind.publish({"force": [0.0, 0.0, 0.0]})
    sim.step(30)
    assert body(sim).worldLinearVelocity[:] == pytest.approx([part / mass for part in force], rel=1e-6)


def test_a_torque_of_the_surroundings_turns_about_the_axes_of_the_world(simulate):
    sim = load(simulate, "robot.rotate(0, 0, 2.0)\nwind = ExternalForce()\nrobot.append(wind)")
    inertia = body(sim).localInertia[2]
    sim.robot.wind.publish({"torque": [0.0, 0.0, 0.1]})
    sim.step(60)
    assert body(sim).worldAngularVelocity[:] == pytest.approx((0.0, 0.0, 0.1 / inertia), rel=1e-3, abs=1e-3 / inertia)
    assert body(sim).worldLinearVelocity.length == pytest.approx(0.0, abs=1e-6)


def test_wind_on_a_point_is_its_force_and_the_torque_about_the_centre_of_mass(simulate):
    """A force F at r does as F at the centre of mass with r x F, while the robot has hardly turned."""
    point, force = (0.4, -0.3, 0.2), (0.02, 0.05, -0.03)
    torque = [
        point[1] * force[2] - point[2] * force[1],
        point[2] * force[0] - point[0] * force[2],
        point[0] * force[1] - point[1] * force[0],
    ]
    motions = []
    for more, command in (
        ("push = ExternalForce()", {"force": force, "torque": torque}),
        (f"push = ForceTorque()\npush.translate{point}", {"force": force}),
    ):
        sim = load(simulate, more + "\nrobot.append(push)")
        sim.robot.push.publish(command)
        sim.step(12)
        motions.append([*body(sim).worldLinearVelocity[:], *body(sim).worldAngularVelocity[:]])
    assert max(map(abs, motions[0][3:])) > 1e-3
    assert motions[0] == pytest.approx(motions[1], rel=0.02, abs=1e-4)


@pytest.mark.parametrize("heading", [0.0, 1.2])
def test_wind_and_thrust_differ_by_the_axes(simulate, heading):
    push = "push = ForceTorque()\npush.properties(RobotFrame=True)\nrobot.append(push)"
    sim = load(simulate, f"robot.rotate(0, 0, {heading})\nwind = ExternalForce()\nrobot.append(wind)\n{push}")
    sim.robot.wind.publish({"force": [-0.5 * math.cos(heading), -0.5 * math.sin(heading), 0.0]})
    sim.robot.push.publish({"force": [0.5, 0.0, 0.0]})
    sim.step(60)
    assert body(sim).worldLinearVelocity.length == pytest.approx(0.0, abs=1e-6)


def test_the_terminal_speed_of_drag_is_the_root_of_force_over_coefficient(simulate):
    sim = load(
        simulate,
        "robot.rotate(0, 0, 1.0)\npush = ForceTorque()\nrobot.append(push)\ndrag = Drag()\n"
        "drag.properties(DragCoeffX=0.5, DragCoeffY=2.0)\nrobot.append(drag)",
    )
    sim.robot.push.publish({"force": [2.0, -0.5, 0.0]})
    sim.step(60 * 15)
    assert body(sim).localLinearVelocity[:2] == pytest.approx((math.sqrt(2.0 / 0.5), -math.sqrt(0.5 / 2.0)), rel=0.01)


def test_drag_slows_down_as_one_over_time(simulate):
    sim = load(simulate, "drag = Drag()\ndrag.properties(DragCoeffX=0.4)\nrobot.append(drag)")
    sim.step(2)
    body(sim).localLinearVelocity = (5.0, 0.0, 0.0)
    sim.step(120)
    # v' = -C v^2 / m
    assert body(sim).localLinearVelocity[0] == pytest.approx(5.0 / (1.0 + 0.4 * 5.0 * 2.0), rel=0.03)


def test_no_drag_turns_a_robot_back(simulate):
    sim = load(
        simulate, "drag = Drag()\ndrag.properties(DragCoeffX=1e6, DragCoeffY=1e6, DragCoeffZ=1e6)\nrobot.append(drag)"
    )
    sim.step(2)
    body(sim).localLinearVelocity = (5.0, -3.0, 1.0)
    sim.step(10)
    assert body(sim).localLinearVelocity.length < 0.01


@pytest.mark.parametrize(
    "wrong", [{"force": [math.nan, 0, 0]}, {"force": [1e12, 0, 0]}, {"force": [1.0]}, {"force": "up"}]
)
def test_forces_that_are_none_are_refused(simulate, wrong):
    sim = load(simulate, "motion = ForceTorque()\nrobot.append(motion)")
    with pytest.raises(Exception, match="force"):
        sim.robot.motion.publish({"force": wrong})
    sim.step(10)
    assert body(sim).worldLinearVelocity.length == 0.0


@pytest.mark.parametrize(("frequency", "ticks"), [(60, 60), (20, 60), (60, 240)])
def test_a_force_pulls_all_the_time_whatever_the_frequency_of_its_actuator(simulate, frequency, ticks):
    more = f"motion = ForceTorque()\nmotion.frequency({frequency})\nrobot.append(motion)"
    sim = simulate(
        SCENE.format(more=more) + f"env = Environment('empty')\nenv.simulator_frequency({ticks})", sockets=False
    )
    sim.robot.motion.publish({"force": [0.6, 0.0, 0.0]})
    sim.step(ticks)
    assert body(sim).worldLinearVelocity[0] == pytest.approx(0.6, abs=0.02)
