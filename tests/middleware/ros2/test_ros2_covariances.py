"""Covariances are those of the errors that a scene declares: compared with the errors of many sensors."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from desk import Desk

Start = Callable[..., tuple[Any, Desk]]

MANY = 80
PATHS = """
motion = MotionVW(); robot.append(motion)
for number in range({many} + 1):
    sensor = Odometry(f"path{{number}}"); sensor.translate(0.3, 0.2, 0.0); sensor.rotate(0.0, 0.0, 0.7)
    options = dict(factor_sigma=0.2, gyro_drift_sigma=0.02) if number else {{}}
    sensor.alter("OdometryNoise", factor=1.0, **options)
    sensor.add_stream("ros2", tf=False)
    robot.append(sensor)
"""


def matrix(numbers: Any) -> Any:
    """(6, 6): row-major, the order of geometry_msgs/PoseWithCovariance."""
    return np.reshape(numbers, (6, 6))


def plane(pose: Any) -> Any:
    q = pose.orientation
    return np.array([pose.position.x, pose.position.y, 2.0 * math.atan2(q.z, q.w)])


def test_the_errors_of_many_odometries_are_as_large_as_each_says(start: Start) -> None:
    sim, desk = start(PATHS.format(many=MANY), connected="motion.add_stream('ros2')", seed=3)
    types = desk.store.types
    vector = types["geometry_msgs/msg/Vector3"]
    desk.send("/robot/cmd_vel", linear=vector(1.0, 0.0, 0.0), angular=vector(0.0, 0.0, 0.4))
    sim.step(150)
    ideal, *others = [desk.last(f"/robot/path{number}") for number in range(MANY + 1)]
    errors = np.array([plane(other.pose.pose) - plane(ideal.pose.pose) for other in others])
    declared = [matrix(other.pose.covariance)[np.ix_((0, 1, 5), (0, 1, 5))] for other in others]
    distances = [error @ np.linalg.solve(spread, error) for error, spread in zip(errors, declared, strict=True)]
    # the mean of chi-squared numbers of three degrees of freedom
    assert np.mean(distances) == pytest.approx(3.0, abs=4.0 * math.sqrt(6.0 / MANY))
    np.testing.assert_allclose(matrix(others[0].pose.covariance)[5, 5], 150 * 0.02**2, rtol=0.02)
    assert not matrix(ideal.pose.covariance).any(), "unknown"
    twist = matrix(others[0].twist.covariance)
    assert twist[5, 5] == pytest.approx((0.02 * 60.0) ** 2)
    rates = [other.twist.twist.angular.z for other in others]
    assert np.std(rates) == pytest.approx(0.02 * 60.0, rel=0.3)
    speeds = np.array([[o.twist.twist.linear.x, o.twist.twist.linear.y] for o in others])
    spread = np.mean([matrix(other.twist.covariance)[:2, :2] for other in others], axis=0)
    np.testing.assert_allclose(np.cov(speeds.T), spread, atol=0.4 * spread.max())


def test_white_noise_is_that_of_the_robot_wherever_the_sensor_is(start: Start) -> None:
    sim, desk = start(
        "path = Odometry('path'); path.translate(2.0, 0.0, 0.0); path.rotate(0.0, 0.0, math.pi / 2)\n"
        "path.noise(gaussian=0.1, field='x'); path.noise(gaussian=0.01, field='yaw')\n"
        "path.noise(gaussian=0.3, field='wz'); robot.append(path)"
    )
    sim.step(2)
    message = desk.last("/robot/path")
    pose, twist = matrix(message.pose.covariance), matrix(message.twist.covariance)
    # X of the sensor is Y of the robot, and an arm of 2 m makes 2 cm of an angle of 0.01
    assert pose[1, 1] == pytest.approx(0.1**2 + (2.0 * 0.01) ** 2, rel=0.05)
    assert pose[0, 0] == pytest.approx(0.0, abs=1e-5)
    assert pose[5, 5] == pytest.approx(0.01**2)
    assert pose[1, 5] == pytest.approx(-2.0 * 0.01**2, rel=0.05)
    assert twist[5, 5] == pytest.approx(0.3**2)
    assert twist[1, 1] == pytest.approx((2.0 * 0.3) ** 2)


def test_a_bias_that_walks_becomes_less_certain(start: Start) -> None:
    sim, desk = start("pose = Pose('pose'); pose.noise(bias_walk=0.2, field='x'); robot.append(pose)")
    variances = []
    for _ in range(2):
        sim.step(60)
        variances.append(matrix(desk.last("/robot/pose").pose.covariance)[0, 0])
    assert np.diff(variances) == pytest.approx(0.2**2, rel=0.05), "in each second"
    assert variances[0] == pytest.approx(0.2**2, rel=0.05)


def test_steps_and_axes(start: Start) -> None:
    sim, desk = start(
        "pose = Pose('pose'); pose.noise(quantization=0.3, field='y'); robot.append(pose)\n"
        "imu = IMU('imu'); imu.alter('IMUNoise', gyro_std={'x': 0.1, 'z': 0.3}, accel_std=0.2); robot.append(imu)\n"
        "device = IMU('device'); device.properties(GyroNoiseDensity=1e-3, GyroBiasInstability=0.02)\n"
        "robot.append(device)\n"
        "turn = Gyroscope('turn'); turn.alter('Noise', rot_std=0.05); robot.append(turn)\n"
        "far = RadarAltimeter('far'); far.noise(gaussian=0.05); robot.append(far)"
    )
    sim.step(2)
    assert matrix(desk.last("/robot/pose").pose.covariance)[1, 1] == pytest.approx(0.3**2 / 12.0), "uniform"
    imu = desk.last("/robot/imu/data")
    assert np.reshape(imu.angular_velocity_covariance, (3, 3)) == pytest.approx(np.diag([0.01, 0.0, 0.09]))
    assert np.reshape(imu.linear_acceleration_covariance, (3, 3)) == pytest.approx(np.eye(3) * 0.04)
    assert imu.orientation_covariance[0] == -1.0
    # the bias is a Gauss-Markov process, whose Allan deviation has a maximum of 0.6175 standard deviations
    device = desk.last("/robot/device/data")
    assert device.angular_velocity_covariance[0] == pytest.approx(60e-6 + (0.02 / 0.6175) ** 2)
    turn = desk.last("/robot/turn")
    assert np.reshape(turn.orientation_covariance, (3, 3)) == pytest.approx(np.eye(3) * 0.05**2)
    assert turn.linear_acceleration_covariance[0] == -1.0
    assert desk.last("/robot/far").variance == pytest.approx(0.05**2)
