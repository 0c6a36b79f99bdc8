"""From the frame of the scanner into that of the room."""

import math

found = set()


def add(pose, ranges):
    x, y, yaw = pose
    for k, distance in enumerate(ranges):
        if distance < 19.9:
            angle = yaw + math.radians(k - 180)
            distance += 0.03
            found.add(
                (math.floor((x + distance * math.cos(angle)) / 0.5), math.floor((y + distance * math.sin(angle)) / 0.5))
            )


def cells():
    return found
