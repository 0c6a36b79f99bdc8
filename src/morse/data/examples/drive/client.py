"""Drives a square of 1 m with odometry only."""

import math

from pymorse import Morse

SIDE, SPEED, TURN = 1.0, 0.6, 1.0  # m, m/s, rad/s


def error(heading, here):
    """How far to turn to the left."""
    return math.remainder(heading - here["yaw"], math.tau)


def turn(robot, heading):
    """Turns on the spot."""
    left = math.tau
    while abs(left) > 0.02:
        left = error(heading, robot.odometry.get())
        robot.motion.publish({"v": 0.0, "w": max(-TURN, min(TURN, 3.0 * left))})


def straight(robot, heading):
    """Drives one side, slower near its end; back if a late message has let it drive too far."""
    begun = robot.odometry.get()
    left = SIDE
    while abs(left) > 0.01:
        here = robot.odometry.get()
        driven = [here[axis] - begun[axis] for axis in "xy"]
        left = SIDE - driven[0] * math.cos(heading) - driven[1] * math.sin(heading)
        robot.motion.publish({"v": max(-SPEED, min(SPEED, 2.0 * left)), "w": 2.0 * error(heading, here)})


def main():
    """Returns the final position relative to the start: measured by odometry, and true, metres."""
    with Morse() as simu:
        robot = simu.robot
        start, first = robot.pose.get(), robot.odometry.get()["yaw"]
        for side in range(4):
            straight(robot, first + side * math.pi / 2)
            turn(robot, first + (side + 1) * math.pi / 2)
        robot.motion.publish({"v": 0.0, "w": 0.0})
        simu.sleep(0.5)
        said, is_at = robot.odometry.get(), robot.pose.get()
        return (said["x"], said["y"]), (is_at["x"] - start["x"], is_at["y"] - start["y"])


if __name__ == "__main__":
    print("The square ends at (%.2f, %.2f) by the wheels, at (%.2f, %.2f) in the world." % sum(main(), ()))
