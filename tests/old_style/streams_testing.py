#! /usr/bin/env python
"""Streams open when components are read; the first actuator has the last word."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class StreamsTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        first = MotionXYW()
        first.properties(ControlType="Position")
        robot.append(first)
        second = MotionVW()
        second.properties(ControlType="Position")
        robot.append(second)
        pose = Pose()
        robot.append(pose)
        clock = Clock()
        robot.append(clock)
        robot.add_default_interface("socket")
        env = Environment("empty", fastmode=True)

    def test_streams(self):
        with Morse() as simu:
            pose, clock = simu.robot.pose, simu.robot.clock
            pose.get()
            simu.sleep(0.1)
            self.assertIsNotNone(clock.last())

    def test_order(self):
        with Morse() as simu:
            simu.robot.first.publish({"x": 0.0, "y": 1.0, "w": 0.0})
            simu.robot.second.publish({"v": 1.0, "w": 0.0})
            simu.sleep(1.0)
            here = simu.robot.pose.get()
            self.assertAlmostEqual(here["y"], 1.0, delta=0.05)
            self.assertAlmostEqual(here["x"], 0.0, delta=0.05)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(StreamsTest)
