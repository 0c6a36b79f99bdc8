#! /usr/bin/env python
"""A car that is driven forward and braked twice, and drives back."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class SteerForceTest(MorseTestCase):
    def setUpEnv(self):
        robot = Hummer()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = SteerForce()
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("land-1/rosace_1", fastmode=True)
        env.add_service("socket")

    def drive(self, morse, force, seconds, brake):
        motion = morse.robot.motion
        motion.publish({"steer": 0.0, "force": force, "brake": 0.0})
        morse.sleep(seconds)
        if brake:
            motion.publish({"steer": 0.0, "force": 0.0, "brake": 10.0})
            morse.sleep(2.5)
        return morse.robot.pose.get()["x"]

    def test_drive(self):
        with Morse() as morse:
            morse.sleep(0.5)
            begin = morse.robot.pose.get()
            self.assertAlmostEqual(begin["x"], 0.0, delta=0.1)
            self.assertAlmostEqual(self.drive(morse, -20.0, 3.0, True), 8.5, delta=1.0)
            self.assertAlmostEqual(self.drive(morse, -20.0, 5.0, True), 28.0, delta=1.0)
            self.assertAlmostEqual(self.drive(morse, 10.0, 11.0, False), 0.0, delta=1.5)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(SteerForceTest)
