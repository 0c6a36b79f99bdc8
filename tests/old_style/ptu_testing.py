#! /usr/bin/env python
"""A pan-tilt unit turns what is on it, by services and by its stream."""

import math

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse, MorseServiceFailed


class PTUTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        ptu = PTU()
        ptu.translate(z=1.0)
        robot.append(ptu)
        ptu.add_interface("socket")
        posture = PTUPosture()
        ptu.append(posture)
        posture.add_stream("socket")
        pose = Pose()
        ptu.append(pose)
        pose.add_stream("socket")
        target = Cube("target")
        target.translate(2.0, -2.0, 1.0)
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def assertLooks(self, simu, pan, tilt):
        angles = simu.robot.ptu.posture.get()
        self.assertAlmostEqual(angles["pan"], pan, delta=0.02)
        self.assertAlmostEqual(angles["tilt"], tilt, delta=0.02)
        pose = simu.robot.ptu.pose.get()
        self.assertAlmostEqual(pose["yaw"], pan, delta=0.02)
        self.assertAlmostEqual(pose["pitch"], tilt, delta=0.02)

    def test_looks(self):
        with Morse() as simu:
            ptu = simu.robot.ptu
            before = simu.time()
            ptu.set_pan_tilt(1.0, 0.5).result()
            self.assertAlmostEqual(simu.time() - before, 1.0, delta=0.15)
            self.assertLooks(simu, 1.0, 0.5)
            pan, tilt = ptu.get_pan_tilt().result()
            self.assertAlmostEqual(pan, 1.0, delta=0.02)
            self.assertAlmostEqual(tilt, 0.5, delta=0.02)
            ptu.look_at_object("target").result()
            self.assertLooks(simu, -math.pi / 4, 0.0)
            ptu.look_at_point(2.0, 2.0, 1.0).result()
            self.assertLooks(simu, math.pi / 4, 0.0)
            self.assertIsInstance(ptu.look_at_object("nothing").exception(), MorseServiceFailed)
            ptu.publish({"pan": 0.0, "tilt": -0.3})
            simu.sleep(1.5)
            self.assertLooks(simu, 0.0, -0.3)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(PTUTest)
