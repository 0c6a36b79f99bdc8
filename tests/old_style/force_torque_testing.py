#! /usr/bin/env python
"""Forces on a robot that is held at its height."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class ForceTorqueTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(z=1.0)
        robot._bpy_object.game.lock_location_z = True
        speed = Velocity()
        robot.append(speed)
        speed.add_stream("socket")
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        push = ForceTorque()
        robot.append(push)
        push.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_force(self):
        with Morse() as simu:
            speed, push = simu.robot.speed, simu.robot.push
            speed.get()
            push.publish({"force": [100.0, 0.0, 0.0], "torque": [0.0, 0.0, 0.0]})
            simu.sleep(1.0)
            self.assertAlmostEqual(speed.last()["linear_velocity"][0], 5.0, delta=0.25)
            simu.sleep(1.0)
            self.assertAlmostEqual(speed.last()["linear_velocity"][0], 10.0, delta=0.25)
            push.publish({"force": [0.0, 0.0, 0.0], "torque": [0.0, 0.0, 0.0]})
            simu.sleep(1.0)
            self.assertAlmostEqual(speed.last()["linear_velocity"][0], 9.8, delta=0.2)
            here = simu.robot.pose.get()
            self.assertAlmostEqual(here["pitch"], 0.0, delta=0.01)
            self.assertAlmostEqual(here["roll"], 0.0, delta=0.01)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(ForceTorqueTest)
