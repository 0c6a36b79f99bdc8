#! /usr/bin/env python
"""Arcs of a robot with forward speed and yaw rate."""

import math

from morse.testing.testing import MorseMoveTestCase, main
from pymorse import Morse


class VOmegaTest(MorseMoveTestCase):
    def setUpEnv(self):
        robot = ATRV()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = MotionVW()
        robot.append(motion)
        motion.add_stream("socket")
        motion.add_service("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_arcs(self):
        with Morse() as simu:
            simu.deactivate("robot.teleport")
            self.assertAlmostEqualPositionThenFix(simu, [0.0, 0.0, 0.10, 0.0, 0.0, 0.0], 0.03)
            motion = simu.robot.motion
            radius = 4.0 / math.pi
            for command, seconds, goal in (
                ({"v": 1.0, "w": 0.0}, 2.0, [2.0, 0.0, 0.10, 0.0, 0.0, 0.0]),
                ({"v": -1.0, "w": 0.0}, 2.0, [0.0, 0.0, 0.10, 0.0, 0.0, 0.0]),
                ({"v": 1.0, "w": -math.pi / 4}, 2.0, [radius, -radius, 0.10, -math.pi / 2, 0.0, 0.0]),
                ({"v": 0.5, "w": -math.pi / 8}, 12.0, [0.0, 0.0, 0.10, 0.0, 0.0, 0.0]),
                ({"v": -2.0, "w": math.pi / 2}, 3.0, [radius, -radius, 0.10, -math.pi / 2, 0.0, 0.0]),
            ):
                motion.publish(command)
                simu.sleep(seconds + 0.1)
                motion.stop().result()
                simu.sleep(0.1)
                self.assertAlmostEqualPositionThenFix(simu, goal, 0.20)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(VOmegaTest)
