"""Sends the robot to waypoints; each call ends when the robot has arrived."""

from pymorse import Morse

PLACES = [(8.0, 0.0), (8.0, 5.0), (0.0, 5.0)]
TOLERANCE = 0.5  # m


def main():
    """Returns the position of the robot at the end of each call."""
    visited = []
    with Morse() as simu:
        for x, y in PLACES:
            answer = simu.robot.goal.goto(x, y, 0.0, TOLERANCE, 1.5).result()
            pose = simu.robot.pose.get()
            print("%s: (%.1f, %.1f), after %.1f s" % (answer, pose["x"], pose["y"], simu.time()))
            visited.append((pose["x"], pose["y"]))
    return visited


if __name__ == "__main__":
    main()
