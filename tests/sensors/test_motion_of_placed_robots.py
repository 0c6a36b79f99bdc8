"""A robot that is placed elsewhere has not moved there: sensors of motion measure what happens afterwards."""

import numpy as np
import pytest

import morse

PERIOD = 1.0 / 60.0


def moved(mode):
    def scene():
        from morse.builder import ATRV, IMU, Accelerometer, Environment, MotionVW, Odometry, Velocity

        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        for part in (Accelerometer("accelerometer"), IMU("imu"), Velocity("velocity")):
            part.properties(ComputationMode=mode)
            robot.append(part)
        robot.append(Odometry("odometry"))
        for level in ("raw", "differential"):
            odometry = Odometry(level)
            odometry.level(level)
            robot.append(odometry)
        Environment("empty")

    return scene


@pytest.mark.parametrize("mode", ["Velocity", "Position"])
@pytest.mark.parametrize("is_read", [False, True])
@pytest.mark.parametrize("ticks", [0, 1, 30])
def test_no_sensor_takes_a_placement_for_a_motion(mode, is_read, ticks):
    with morse.load(moved(mode)) as sim:
        robot = sim.robot
        robot.motion.publish({"v": 1.0, "w": 0.0})
        sim.step(ticks)
        if is_read:
            assert robot.odometry.data["x"] == pytest.approx(ticks * PERIOD, abs=1e-3)
        sim.place("robot", [5.0, -5.0, 1.0])
        sim.measure()
        if is_read:
            data = robot.odometry.data
            assert [data[name] for name in ("x", "y", "yaw")] == pytest.approx([5.0, -5.0, 1.0], abs=1e-6)
            for name in ("vx", "vy", "vz", "wx", "wy", "wz"):
                assert data[name] == pytest.approx(0.0, abs=1e-6)
            for sensor, fields in {
                "accelerometer": ("distance", "velocity", "acceleration", "angular_acceleration"),
                "imu": ("angular_velocity",),
                "velocity": ("linear_velocity", "angular_velocity"),
                "raw": ("dS",),
                "differential": ("dx", "dy", "dyaw"),
            }.items():
                for field in fields:
                    value = np.asarray(robot.parts[sensor].data[field])
                    assert value == pytest.approx(np.zeros(value.shape), abs=1e-6), (sensor, field)
            assert np.linalg.norm(robot.imu.data["linear_acceleration"]) == pytest.approx(9.81, abs=0.01)
        sim.step(2)
        data = robot.odometry.data
        assert [data["vx"], data["vy"], data["wz"]] == pytest.approx([1.0, 0.0, 0.0], abs=0.01)
        assert robot.raw.data["dS"] == pytest.approx(PERIOD, rel=0.02)
        assert robot.accelerometer.data["distance"] == pytest.approx(PERIOD, rel=0.02)
        assert robot.velocity.data["linear_velocity"] == pytest.approx([1.0, 0.0, 0.0], abs=0.02)
