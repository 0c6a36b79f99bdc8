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


def test_wind_pushes_along_the_world_whatever_the_heading(simulate):
    sim = load(simulate, "robot.rotate(0, 0, 2.0)\nwind = ExternalForce()\nrobot.append(wind)")
    sim.robot.wind.publish({"force": [0.5, 0.25, 0.0]})
    sim.step(60)
    assert body(sim).worldLinearVelocity[:] == pytest.approx((0.5, 0.25, 0.0), abs=0.02)


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
