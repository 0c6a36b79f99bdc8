#! /usr/bin/env python
"""The pose of a robot at its start, and after it was teleported."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class PoseTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV("robot")
        robot.translate(3.0, -1.0, 0.2)
        pose = Pose("pose")
        robot.append(pose)
        pose.add_stream("socket")
        teleport = Teleport("teleport")
        robot.append(teleport)
        teleport.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_pose(self):
        with Morse() as morse:
            pose = morse.robot.pose
            here = pose.get()
            self.assertAlmostEqual(here["x"], 3.0, delta=0.03)
            self.assertAlmostEqual(here["y"], -1.0, delta=0.03)
            # an active teleport holds the start pose
            self.assertAlmostEqual(here["z"], 0.3, delta=0.001)
            morse.robot.teleport.publish({"x": 5.0, "y": 2.0, "z": 0.5, "yaw": 1.0, "pitch": 0.0, "roll": 0.0})
            morse.sleep(0.1)
            here = pose.last()
            for name, value in (("x", 5.0), ("y", 2.0), ("z", 0.5), ("yaw", 1.0)):
                self.assertAlmostEqual(here[name], value, delta=0.001)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(PoseTest)
