"""Flies from waypoint to waypoint; the last one is on the ground."""

from pymorse import Morse

ROUND = [(0.0, 0.0, 3.0), (4.0, 0.0, 3.0), (4.0, 3.0, 4.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.2)]


def main():
    """Returns the distance from each waypoint when the service had ended, m."""
    errors = []
    with Morse() as simu:
        for x, y, z in ROUND:
            simu.robot.pilot.goto(x, y, z, 0.0, 0.3).result()
            pose = simu.robot.pose.get()
            errors.append(((pose["x"] - x) ** 2 + (pose["y"] - y) ** 2 + (pose["z"] - z) ** 2) ** 0.5)
            print("At (%.1f, %.1f, %.1f) after %.1f s." % (pose["x"], pose["y"], pose["z"], simu.time()))
    return errors


if __name__ == "__main__":
    main()
