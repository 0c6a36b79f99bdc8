"""Waits until the cars have red for long enough, and crosses the road."""

import math

from pymorse import Morse

LIGHT, NEEDED = "light_0", 9.0


def main():
    """Returns the end of the way (x, y), m, the smallest distance to a car, m, and the colour at the start."""
    with Morse() as simu:
        robot = simu.robot
        while True:
            light = simu.rpc(LIGHT, "get_local_data")
            if light["state"] == "red" and NEEDED < light["remaining"] < 14.5:
                break
            simu.sleep(0.1)
        nearest = math.inf
        while True:
            place = robot.pose.get()
            for x, y, _ in simu.rpc("cars", "get_local_data")["positions"]:
                nearest = min(nearest, math.hypot(x - place["x"], y - place["y"]))
            if place["y"] > 5.5:
                break
            turn = math.atan2(8.0 - place["y"], 6.5 - place["x"]) - place["yaw"]
            robot.motion.publish({"v": 1.5, "w": math.remainder(turn, math.tau)})
        robot.motion.publish({"v": 0.0, "w": 0.0})
        return (place["x"], place["y"]), nearest, light["state"]


if __name__ == "__main__":
    print("Crossed to (%.1f, %.1f)." % main()[0])
