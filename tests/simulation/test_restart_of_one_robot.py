"""One robot restarts while the others go on."""

import numpy as np
import pytest

import morse


def two():
    """Two robots with noisy sensors, and a crate that falls."""
    from morse.builder import ATRV, GPS, IMU, Cube, Environment, MotionVW, Odometry, Pose

    for number, name in enumerate(("one", "two")):
        robot = ATRV(name)
        robot.translate(y=6.0 * number)
        pose = Pose("pose")
        pose.alter("Noise", pos_std=0.1)
        for part in (MotionVW("motion"), pose, Odometry("odometry"), IMU("imu"), GPS("gps")):
            robot.append(part)
    crate = Cube("Crate")
    crate.scale, crate.location = (0.5, 0.5, 0.5), (0.0, -8.0, 3.0)
    crate._bpy_object.game.physics_type = "RIGID_BODY"
    Environment("empty")


def drive(sim):
    sim.one.motion.publish({"v": 1.0, "w": 0.3})
    sim.two.motion.publish({"v": 0.7, "w": -0.2})
    sim.step(40)


def data_of(robot):
    return {name: robot[name].data for name in ("pose", "odometry", "imu", "gps")}


def equal(first, second, but=("timestamp",)):
    for name, data in first.items():
        for field, value in data.items():
            if field not in but:
                assert np.array_equal(value, second[name][field]), (name, field)


def test_the_others_go_on_and_it_is_as_after_the_load():
    with morse.load(two, seed=3) as sim, morse.load(two, seed=3) as other, morse.load(two, seed=9) as fresh:
        drive(sim)
        drive(other)
        sim.one.set_mass(80.0)
        pose = sim.one.pose
        sim.one.restart(9)
        assert sim.ticks == 40
        assert sim.one.motion.component.local_data["v"] == 0.0
        sim.step(30)
        other.step(30)
        fresh.step(30)
        equal(data_of(sim.two), data_of(other.two))
        crates = [one.world.objects_by_name["Crate"].world_pose() for one in (sim, other)]
        assert crates[0] == crates[1]
        assert pose.data["x"] == pytest.approx(0.0, abs=1.0)
        assert sim.one.component.bge_object.mass == fresh.one.component.bge_object.mass
        # as many measurements as after the load, with the same noise of 0.1 m
        for field in ("x", "y", "yaw"):
            assert sim.one.pose.data[field] == pytest.approx(fresh.one.pose.data[field], abs=1e-6)


def test_it_is_part_of_the_state():
    with morse.load(two, seed=3) as sim, morse.load(two, seed=3) as other:
        drive(sim)
        sim.one.restart(11)
        other.restore(sim.save())
        sim.step(20)
        other.step(20)
        assert sim.state_hash() == other.state_hash()
        sim.restart()
        other.restart(3)
        assert sim.state_hash() == other.state_hash()


def test_a_spawned_robot_restarts_and_a_wrong_name_is_named():
    with morse.load(two) as sim:
        sim.spawn("third", "ATRV", (5.0, 0.0, 0.2))
        sim.place("third", [9.0, 0.0, 0.0])
        sim.third.restart()
        assert sim.third.component.bge_object.worldPosition[0] == pytest.approx(5.0)
        with pytest.raises(KeyError, match="there is no robot 'thrid'; did you mean 'third'"):
            sim.restart_robot("thrid")


def mechanisms():
    """A robot on wheels with an arm in which a cube is held, an arm alone, and a robot that lies in the way."""
    from morse.builder import ATRV, Environment, KukaLWR, MotionVW, MotionVWDiff, Pose, SegwayRMP400

    wheels = SegwayRMP400("wheels")
    arm = ATRV("arm")
    arm.translate(y=6.0)
    kuka = KukaLWR("kuka")
    kuka.translate(z=0.9)
    arm.append(kuka)
    other = ATRV("other")
    other.translate(y=-6.0)
    for robot, motion in ((wheels, MotionVWDiff("motion")), (arm, MotionVW("motion")), (other, MotionVW("motion"))):
        robot.append(motion)
        robot.append(Pose("pose"))
    Environment("empty")


@pytest.mark.parametrize("name", ["wheels", "arm", "other"])
def test_wheels_and_joints_start_again_and_the_model_is_compiled_once(name):
    with morse.load(mechanisms, seed=3) as sim, morse.load(mechanisms, seed=3) as fresh:
        for robot in ("wheels", "arm", "other"):
            sim[robot].motion.publish({"v": 1.0, "w": 0.4})
        sim.arm.kuka.set_rotation("kuka_2", 1.0)
        sim.step(60)
        order = list(sim.context.components)
        before, rebuilt = {other: sim[other].pose.data for other in sim.robots}, sim.world.arrangement
        sim[name].restart()
        assert sim.world.arrangement == rebuilt + 1
        assert list(sim.context.components) == order
        sim.measure()
        fresh.measure()
        for other in sim.robots:
            expected = fresh[other].pose.data if other == name else before[other]
            for field in ("x", "y", "z", "yaw"):
                assert sim[other].pose.data[field] == pytest.approx(expected[field], abs=1e-9), (other, field)
        sim.step(30)
        fresh.step(30)
        assert sim[name].pose.data["x"] == pytest.approx(fresh[name].pose.data["x"], abs=1e-3)
        if name == "arm":
            assert sim.arm.kuka.data["kuka_2"] == pytest.approx(fresh.arm.kuka.data["kuka_2"], abs=1e-3)
