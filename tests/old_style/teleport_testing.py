#! /usr/bin/env python
"""Relative teleports."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class TeleportTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_service("socket")
        teleport.add_stream("socket")
        motion = MotionVW()
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_services(self):
        with Morse() as morse:
            teleport, pose = morse.robot.teleport, morse.robot.pose
            teleport.translate(1.0, 2.0).result()
            teleport.rotate(0.0, 0.0, 1.0).result()
            teleport.translate(1.0).result()
            morse.sleep(0.1)
            here = pose.last()
            for name, value in (("x", 2.0), ("y", 2.0), ("yaw", 1.0)):
                self.assertAlmostEqual(here[name], value, delta=0.001)
            morse.robot.motion.publish({"v": 1.0, "w": 0.0})
            morse.sleep(0.5)
            self.assertAlmostEqual(pose.last()["x"], 2.0, delta=0.001)
            morse.deactivate("robot.teleport")
            morse.sleep(0.5)
            self.assertGreater(pose.last()["x"], 2.15)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(TeleportTest)
