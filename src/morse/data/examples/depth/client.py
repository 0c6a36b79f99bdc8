"""Reads the depth of the left and the right half of the image, on the row through its centre."""

import base64
import struct

from pymorse import Morse


def main():
    """Returns the smallest distance in each half, m: left, right."""
    with Morse() as simu:
        picture = simu.robot.Kinect.depth.get()
        width, height = picture["width"], picture["height"]
        depths = struct.unpack("<%df" % (width * height), base64.b64decode(picture["image"]))
        row = depths[height // 2 * width : (height // 2 + 1) * width]
        return min(row[: width // 2]), min(row[width // 2 :])


if __name__ == "__main__":
    print("The nearest object is %.2f m away on the left, and %.2f m on the right." % main())
