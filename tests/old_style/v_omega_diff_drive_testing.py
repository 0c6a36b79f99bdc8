#! /usr/bin/env python
"""Ramped arcs of a robot on four wheels."""

import math

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class DiffDriveTest(MorseTestCase):
    def setUpEnv(self):
        robot = SegwayRMP400()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = MotionVWDiff()
        robot.append(motion)
        motion.add_stream("socket")
        motion.add_service("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def ramp(self, simu, v, w, seconds):
        motion = simu.robot.motion
        for share in (0.25, 0.5, 0.75):
            motion.publish({"v": share * v, "w": share * w})
            simu.sleep(seconds / 120.0)
        motion.publish({"v": v, "w": w})
        simu.sleep(seconds)
        for share in (0.75, 0.5, 0.25):
            motion.publish({"v": share * v, "w": share * w})
            simu.sleep(seconds / 120.0)
        motion.publish({"v": 0.0, "w": 0.0})

    def test_circle(self):
        with Morse() as simu:
            start = simu.robot.pose.get()
            self.ramp(simu, 1.0, -math.pi / 4, 2.0)
            self.ramp(simu, 0.5, -math.pi / 8, 12.0)
            simu.sleep(0.5)
            end = simu.robot.pose.get()
            self.assertAlmostEqual(end["x"], start["x"], delta=0.20)
            self.assertAlmostEqual(end["y"], start["y"], delta=0.20)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(DiffDriveTest)
