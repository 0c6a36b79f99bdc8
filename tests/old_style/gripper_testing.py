#! /usr/bin/env python
"""A gripper takes an object, carries it and lets it go."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class GripperTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        gripper = Gripper("gripper")
        gripper.translate(x=0.9, z=0.3)
        robot.append(gripper)
        gripper.add_service("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_nothing(self):
        with Morse() as simu:
            self.assertEqual(simu.robot.gripper.grab().result(), None)
            self.assertEqual(simu.robot.gripper.release().result(), None)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(GripperTest)
