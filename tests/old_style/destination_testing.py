#! /usr/bin/env python
"""A straight way to a destination."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class DestinationTest(MorseTestCase):
    def setUpEnv(self):
        robot = RMax()
        robot.translate(10.0, 8.0, 20.0)
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = Destination()
        motion.properties(Speed="2.0", Tolerance=0.3, RemainAtDestination="True")
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_way(self):
        with Morse() as morse:
            pose, motion = morse.robot.pose, morse.robot.motion
            here = pose.get()
            for name, value in (("x", 10.0), ("y", 8.0), ("z", 20.0)):
                self.assertAlmostEqual(here[name], value, delta=0.03)
            motion.publish({"x": 10.0, "y": 5.0, "z": 20.0})
            morse.sleep(1.0)
            self.assertAlmostEqual(pose.get()["y"], 6.0, delta=0.15)
            morse.sleep(1.0)
            here = pose.get()
            self.assertAlmostEqual(here["y"], 5.0, delta=0.35)
            self.assertAlmostEqual(here["x"], 10.0, delta=0.1)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(DestinationTest)
