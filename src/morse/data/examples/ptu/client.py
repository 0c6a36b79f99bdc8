"""Points the head at the other robot while that robot drives past, one metre at a time."""

from pymorse import Morse


def main():
    """Returns the pan angle, rad, and the position of the other robot, m, at some times."""
    seen = []
    with Morse() as simu:
        for _ in range(3):
            simu.other.motion.publish({"v": 0.8, "w": 0.0})
            simu.sleep(1.0)
            simu.other.motion.publish({"v": 0.0, "w": 0.0})
            simu.sleep(0.1)
            simu.robot.ptu.look_at_object("other").result()
            pan, _ = simu.robot.ptu.get_pan_tilt().result()
            pose = simu.other.pose.get()
            seen.append((pan, pose["x"], pose["y"]))
    return seen


if __name__ == "__main__":
    for pan, x, y in main():
        print("The other robot is at (%.1f, %.1f): the head is turned by %.2f rad." % (x, y, pan))
