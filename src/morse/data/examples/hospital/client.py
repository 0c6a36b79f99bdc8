"""Calls the lift, rides to the upper floor, and drives to the place of the delivery."""

import math

from pymorse import Morse

OUTSIDE, INSIDE, TARGET = (2.8, 0.0), (-1.1, 0.0), (7.0, 0.0)


def turn_to(robot, angle):
    """Turn to a direction, rad."""
    while True:
        left = math.remainder(angle - robot.pose.get()["yaw"], math.tau)
        if abs(left) < 0.05:
            break
        robot.motion.publish({"v": 0.0, "w": max(-1.0, min(1.0, 2.0 * left))})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def go(robot, x, y, speed=1.0, within=0.15):
    """Turn to a place and drive there, m."""
    at = robot.pose.get()
    turn_to(robot, math.atan2(y - at["y"], x - at["x"]))
    while True:
        at = robot.pose.get()
        apart = math.hypot(x - at["x"], y - at["y"])
        if apart < within:
            break
        left = math.remainder(math.atan2(y - at["y"], x - at["x"]) - at["yaw"], math.tau)
        robot.motion.publish({"v": min(speed, 0.2 + apart) * max(0.0, math.cos(left)), "w": 2.0 * left})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def ride_to(simu, level):
    """Call the lift to a floor, and wait until its doors are open there."""
    simu.rpc("lift", "call", level)
    while True:
        lift = simu.rpc("lift", "get_local_data")
        if lift["state"] == "open" and lift["level"] == level:
            break
        simu.sleep(0.1)


def main():
    """Returns the place of the delivery (x, y, z), m."""
    with Morse() as simu:
        robot = simu.robot
        go(robot, *OUTSIDE)
        turn_to(robot, math.pi)
        ride_to(simu, 0)
        simu.rpc("lift", "hold_doors", 14.0)
        simu.sleep(5.0)  # others leave and enter first
        go(robot, *INSIDE, speed=0.7)
        turn_to(robot, 0.0)
        ride_to(simu, 1)
        go(robot, *TARGET)
        at = robot.pose.get()
        return at["x"], at["y"], at["z"]


if __name__ == "__main__":
    print("Delivered at (%.1f, %.1f), %.1f m high." % main())
