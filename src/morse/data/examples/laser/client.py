"""Drives ahead while the way is free, otherwise turns to the side with more space."""

from pymorse import Morse

CLEAR, SECONDS = 1.6, 12.0  # m; simulated s


def main():
    """Returns the driven distance, m, and the smallest measured distance, m."""
    way, nearest = 0.0, float("inf")
    with Morse() as simu:
        robot, before, end = simu.robot, None, simu.time() + SECONDS
        while simu.time() < end:
            ranges = robot.laser.get()["range_list"]
            third = len(ranges) // 3
            right, ahead, left = min(ranges[:third]), min(ranges[third:-third]), min(ranges[-third:])
            if ahead > CLEAR:
                robot.motion.publish(
                    {"v": min(1.0, 0.5 * ahead), "w": 0.3 if right < 0.8 else -0.3 if left < 0.8 else 0.0}
                )
            else:
                robot.motion.publish({"v": 0.0, "w": 0.8 if left > right else -0.8})
            pose = robot.pose.get()
            if before is not None:
                way += ((pose["x"] - before["x"]) ** 2 + (pose["y"] - before["y"]) ** 2) ** 0.5
            before, nearest = pose, min(nearest, *ranges)
        robot.motion.publish({"v": 0.0, "w": 0.0})
    return way, nearest


if __name__ == "__main__":
    print("Drove %.1f m; the smallest distance to an obstacle was %.2f m." % main())
