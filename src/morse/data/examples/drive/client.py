"""Drives a square of 1 m with odometry only."""

import math

from pymorse import Morse

SIDE, SPEED, TURN = 1.0, 0.6, 1.0  # m, m/s, rad/s


def main():
    """Returns the final position relative to the start: measured by odometry, and true, metres."""
    with Morse() as simu:
        robot = simu.robot
        start = robot.pose.get()
        for _ in range(4):
            begun = robot.odometry.get()
            here = begun
            while math.dist((here["x"], here["y"]), (begun["x"], begun["y"])) < SIDE:
                robot.motion.publish({"v": SPEED, "w": 0.0})
                here = robot.odometry.get()
            left = math.pi / 2
            while left > 0.02:
                robot.motion.publish({"v": 0.0, "w": min(TURN, 3.0 * left)})
                now = robot.odometry.get()
                left = math.remainder(here["yaw"] + math.pi / 2 - now["yaw"], math.tau)
            robot.motion.publish({"v": 0.0, "w": 0.0})
        simu.sleep(0.5)
        said, is_at = robot.odometry.get(), robot.pose.get()
        return (said["x"], said["y"]), (is_at["x"] - start["x"], is_at["y"] - start["y"])


if __name__ == "__main__":
    print("The square ends at (%.2f, %.2f) by the wheels, at (%.2f, %.2f) in the world." % sum(main(), ()))
