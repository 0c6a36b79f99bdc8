"""Drives the same path three times: twice with the same seed, and once with another seed."""

from pymorse import Morse

TICKS = 180


def drive(simu, seed):
    """Restart, drive, and return the measurements of the noisy sensor."""
    simu.reset(seed=seed)
    simu.robot.pose.last()
    said = []
    for tick in range(TICKS):
        simu.robot.motion.publish({"v": 0.5, "w": 0.5 if tick > 60 else 0.0})
        simu.step()
        said.append(simu.robot.pose.last())
    return said


def main():
    """Returns whether the first two runs are equal, and whether the first and the third are."""
    with Morse() as simu:
        simu.pause()
        first, again, other = (drive(simu, seed) for seed in (1, 1, 2))
        simu.resume()
    return first == again, first == other


if __name__ == "__main__":
    print("The same seed: %s. Another seed: %s." % tuple("the same" if same else "different" for same in main()))
