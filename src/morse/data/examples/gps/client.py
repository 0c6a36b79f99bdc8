"""Steers by the difference of the coordinates: X of the world points east, Y north."""

import math

from pymorse import Morse

GOAL = (1.43345, 43.60005)  # longitude, latitude, degrees
RADIUS = 6378137.0  # radius of the earth at the equator, m


def metres_to(goal, longitude, latitude):
    """The offset of the goal to the east and to the north, m; accurate for some kilometres."""
    east = math.radians(goal[0] - longitude) * RADIUS * math.cos(math.radians(latitude))
    return east, math.radians(goal[1] - latitude) * RADIUS


def main():
    """Returns the final distance of the car from the goal, m."""
    with Morse() as simu:
        robot, end = simu.robot, simu.time() + 60.0
        while simu.time() < end:
            fix = robot.gps.get()
            east, north = metres_to(GOAL, fix["longitude"], fix["latitude"])
            distance = math.hypot(east, north)
            if distance < 0.5:
                break
            aside = math.remainder(math.atan2(north, east) - robot.gyroscope.get()["yaw"], math.tau)
            robot.motion.publish({"v": min(2.0, distance) * max(0.0, math.cos(aside)), "w": 1.5 * aside})
        robot.motion.publish({"v": 0.0, "w": 0.0})
        return distance


if __name__ == "__main__":
    print("Stopped %.2f m from the goal." % main())
