"""Fetches a visitor at the entrance, guides the visitor to a shop, and returns."""

import math

from pymorse import Morse

DESK, ENTRANCE, AISLE, DOOR, SHOP = (-18.0, -0.8), (-20.5, 1.2), (-17.0, 3.6), (3.0, 3.6), (3.0, 8.5)
#: m: of a visitor who is lost sight of, and of somebody ahead for whom the robot stops
LOST, NEAR = 4.0, 0.7


def turn_to(robot, angle):
    """Turn to a direction, rad."""
    while True:
        left = math.remainder(angle - robot.pose.get()["yaw"], math.tau)
        if abs(left) < 0.1:
            break
        robot.motion.publish({"v": 0.0, "w": max(-1.0, min(1.0, 2.0 * left))})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def go(simu, x, y, visitor=None):
    """Turn to a place and drive there, m; stop for people, and wait for the visitor who follows."""
    robot = simu.robot
    at = robot.pose.get()
    turn_to(robot, math.atan2(y - at["y"], x - at["x"]))
    while True:
        at = robot.pose.get()
        apart = math.hypot(x - at["x"], y - at["y"])
        if apart < 0.3:
            break
        left = math.remainder(math.atan2(y - at["y"], x - at["x"]) - at["yaw"], math.tau)
        speed = min(1.0, 0.2 + apart, max(0.0, min(robot.scan.get()["range_list"]) - NEAR))
        if visitor is not None and behind(simu, at, visitor) > LOST:
            speed = 0.0
        robot.motion.publish({"v": speed * max(0.0, math.cos(left)), "w": 2.0 * left})
    robot.motion.publish({"v": 0.0, "w": 0.0})


def behind(simu, at, visitor):
    """The distance of a visitor, m."""
    x, y = simu.rpc("visitors", "ask", visitor)["position"]
    return math.hypot(x - at["x"], y - at["y"])


def main():
    """Returns where the visitor was met and is in the end, and where the robot is, (x, y) m."""
    with Morse() as simu:
        go(simu, *ENTRANCE)
        (visitor,) = simu.rpc("visitors", "follow", "robot", 1)
        met = simu.rpc("visitors", "ask", visitor)["position"]
        go(simu, *AISLE, visitor)
        go(simu, *DOOR, visitor)
        simu.rpc("visitors", "send", visitor, *SHOP)
        go(simu, *AISLE)
        go(simu, *DESK)
        at = simu.robot.pose.get()
        while simu.rpc("visitors", "ask", visitor)["state"] == "sent":
            simu.sleep(0.2)
        return met, simu.rpc("visitors", "ask", visitor)["position"], (at["x"], at["y"])


if __name__ == "__main__":
    print("The visitor is in the shop, at (%.1f, %.1f)." % tuple(main()[1]))
