"""Drives to the box, grasps it, turns, and releases it."""

import math

from pymorse import Morse


def place_of(simu, name):
    """The position of an object, m."""
    return simu.rpc("simulation", "get_scene_objects")[name][1]


def main():
    """Returns the name of the grasped object, and the distance by which it was carried, m."""
    with Morse() as simu:
        robot, before = simu.robot, place_of(simu, "tape")
        while robot.pose.get()["x"] < 1.0:
            robot.motion.publish({"v": 0.6, "w": 0.0})
        robot.motion.publish({"v": 0.0, "w": 0.0})
        held = robot.gripper.grab().result()
        while abs(math.remainder(robot.pose.get()["yaw"] - math.pi / 2, math.tau)) > 0.05:
            robot.motion.publish({"v": 0.0, "w": 0.6})
        robot.motion.publish({"v": 0.0, "w": 0.0})
        robot.gripper.release().result()
        simu.sleep(1.0)
        return held, math.dist(before[:2], place_of(simu, "tape")[:2])


if __name__ == "__main__":
    print("Took '%s', and carried it %.1f m." % main())
