#! /usr/bin/env python
"""A robot that moves sideways, and the wind it feels."""

import math

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class XYOmegaTest(MorseTestCase):
    def setUpEnv(self):
        robot = Morsy()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        speed = Velocity()
        robot.append(speed)
        speed.add_stream("socket")
        wind = Airspeed()
        wind.rotate(z=math.pi / 2)
        robot.append(wind)
        wind.add_stream("socket")
        motion = MotionXYW()
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_sideways(self):
        with Morse() as simu:
            simu.robot.speed.get()
            simu.robot.wind.get()
            for commanded, measured, pressure in ((1.0, 0.948, 0.55), (2.0, 1.938, 2.30)):
                simu.robot.motion.publish({"x": 0.0, "y": commanded, "w": 0.0})
                simu.sleep(0.5)
                self.assertAlmostEqual(simu.robot.speed.last()["linear_velocity"][1], measured, delta=0.003)
                self.assertAlmostEqual(simu.robot.wind.last()["diff_pressure"], pressure, delta=0.01)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(XYOmegaTest)
