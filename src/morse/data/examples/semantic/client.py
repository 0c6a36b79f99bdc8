"""Turns once, and collects the objects that the camera reports."""

import math

from pymorse import Morse

RATE = 1.0  # rad/s


def main():
    """Returns the reported objects: name to type."""
    seen = {}
    with Morse() as simu:
        robot, end = simu.robot, simu.time() + math.tau / RATE + 0.5
        robot.motion.publish({"v": 0.0, "w": RATE})
        while simu.time() < end:
            for thing in robot.camera.get()["visible_objects"]:
                seen[thing["name"]] = thing["type"]
        robot.motion.publish({"v": 0.0, "w": 0.0})
    return seen


if __name__ == "__main__":
    for name, kind in sorted(main().items()):
        print("%s: %s" % (name, kind))
