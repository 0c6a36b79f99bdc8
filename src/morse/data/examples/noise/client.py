"""Compares measurements of the same ticks."""

from pymorse import Morse

TICKS = 600


def main():
    """Returns the standard deviation of the noise along X, m, and the last pose: true, and north, east, down."""
    errors = []
    with Morse() as simu:
        simu.pause()  # so that the measurements of all sensors belong to the same tick
        robot = simu.robot
        for sensor in (robot.truth, robot.measured, robot.sea):
            sensor.last()
        robot.motion.publish({"v": 0.5, "w": 0.2})
        for _ in range(TICKS):
            simu.step()
            errors.append(robot.measured.last()["x"] - robot.truth.last()["x"])
        truth, sea = robot.truth.last(), robot.sea.last()
        simu.resume()
    mean = sum(errors) / TICKS
    deviation = (sum((error - mean) ** 2 for error in errors) / TICKS) ** 0.5
    return deviation, (truth["x"], truth["y"], truth["z"]), (sea["x"], sea["y"], sea["z"])


if __name__ == "__main__":
    deviation, truth, sea = main()
    print("Noise of %.3f m. The robot is at (%.2f, %.2f, %.2f); " % (deviation, *truth), end="")
    print("north %.2f, east %.2f, down %.2f." % sea)
