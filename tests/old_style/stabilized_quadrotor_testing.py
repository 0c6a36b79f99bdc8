#! /usr/bin/env python
"""A stabilized quadrotor, commanded at intervals of a second as in MORSE 1.4, where each round took 62 ticks."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class StabilizedQuadrotorTest(MorseTestCase):
    def setUpEnv(self):
        robot = Quadrotor()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = StabilizedQuadrotor()
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def fly(self, morse, axis, direction, **command):
        zero = {"theta_c": 0.0, "phi_c": 0.0, "psi_c": 0.0, "h_c": 0.0}
        begin = morse.robot.pose.get()[axis]
        for given, distance in ((command, 0.4), (command, 1.8), ({}, 4.0), ({}, 6.2)):
            morse.robot.motion.publish(zero | given)
            morse.sleep(1.0)
            pose = morse.robot.pose.get()
            self.assertAlmostEqual(pose[axis], begin + direction * distance, delta=0.2)
            self.assertAlmostEqual(pose["z"], 0.0, delta=0.1)

    def test_pitch(self):
        with Morse() as morse:
            self.fly(morse, "x", 1.0, theta_c=0.1)

    def test_roll(self):
        with Morse() as morse:
            self.fly(morse, "y", -1.0, phi_c=0.1)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(StabilizedQuadrotorTest)
