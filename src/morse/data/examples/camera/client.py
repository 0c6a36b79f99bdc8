"""Finds the red pixels of each image, turns towards them, and stops when there are many."""

import base64

from pymorse import Morse


def red_pixels(picture):
    """Share of red pixels, and the position of their centre: -1 left, 1 right."""
    pixels, width = base64.b64decode(picture["image"]), picture["width"]
    columns = [
        i // 4 % width
        for i in range(0, len(pixels), 4)
        if pixels[i] > 60 and pixels[i] > 2 * pixels[i + 1] and pixels[i] > 2 * pixels[i + 2]
    ]
    if not columns:
        return 0.0, 0.0
    middle = sum(columns) / len(columns) + 0.5
    return 4.0 * len(columns) / len(pixels), 2.0 * middle / width - 1.0


def main():
    """Returns the final position of the robot, m."""
    with Morse() as simu:
        robot, end = simu.robot, simu.time() + 30.0
        while simu.time() < end:
            share, side = red_pixels(robot.camera.get())
            if share > 0.08:
                break
            robot.motion.publish({"v": 0.8 if share else 0.0, "w": -0.8 * side if share else 0.5})
        robot.motion.publish({"v": 0.0, "w": 0.0})
        simu.sleep(0.2)
        pose = robot.pose.get()
        return pose["x"], pose["y"]


if __name__ == "__main__":
    print("Stopped before the ball, at (%.1f, %.1f)." % main())
