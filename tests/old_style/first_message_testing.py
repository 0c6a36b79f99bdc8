#! /usr/bin/env python
"""A robot that is placed a little above the floor stands on it in the first message."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class FirstMessageTest(MorseTestCase):
    def setUpEnv(self):
        robot = SegwayRMP400()
        robot.translate(z=0.1)
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        env = Environment("empty", fastmode=True)

    def test_at_rest(self):
        with Morse() as morse:
            here = morse.robot.pose.get()
            self.assertAlmostEqual(here["z"], 0.20, delta=0.02)
            for name in ("x", "y", "pitch", "roll"):
                self.assertAlmostEqual(here[name], 0.0, delta=0.02)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(FirstMessageTest)
