"""Drives a circle, and integrates the yaw rate."""

import math

from pymorse import Morse

SPEED, RATE, SECONDS = 1.0, 0.5, 8.0  # m/s, rad/s, s


def main():
    """Returns the final error of the heading, rad, and the mean centripetal acceleration, m/s^2."""
    readings = []
    with Morse() as simu:
        simu.pause()  # so that a slow client misses no measurement
        robot = simu.robot
        robot.imu.last()
        robot.motion.publish({"v": SPEED, "w": RATE})
        simu.step(60)
        yaw = robot.pose.get_local_data().result()["yaw"]
        for _ in range(round(60 * SECONDS)):
            simu.step()
            readings.append(robot.imu.last())
            yaw += readings[-1]["angular_velocity"][2] / 60.0
        turned = math.remainder(yaw - robot.pose.get_local_data().result()["yaw"], math.tau)
        simu.resume()
    return turned, sum(reading["linear_acceleration"][1] for reading in readings) / len(readings)


if __name__ == "__main__":
    print("The heading is wrong by %.4f rad; the robot measured %.3f m/s^2 to its left." % main())
