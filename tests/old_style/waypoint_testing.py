#! /usr/bin/env python
"""A robot goes to a place, stops and goes on."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class WaypointTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        motion = Waypoint()
        motion.properties(ObstacleAvoidance=False)
        robot.append(motion)
        motion.add_stream("socket")
        motion.add_service("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_goto(self):
        with Morse() as morse:
            motion, pose = morse.robot.motion, morse.robot.pose
            there = motion.goto(4.0, 0.0, 0.0, 0.5, 1.0)
            morse.sleep(1.0)
            self.assertEqual(motion.get_status().result(), "Transit")
            before = pose.get()["x"]
            motion.stop().result()
            morse.sleep(0.5)
            stopped = pose.get()["x"]
            self.assertAlmostEqual(stopped - before, 0.2, delta=0.06)
            morse.sleep(0.5)
            self.assertAlmostEqual(pose.get()["x"], stopped, delta=0.03)
            self.assertEqual(motion.get_status().result(), "Stop")
            self.assertTrue(there.running())
            motion.resume().result()
            self.assertEqual(there.result(), "Arrived")
            self.assertAlmostEqual(pose.get()["x"], 4.0, delta=0.55)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(WaypointTest)
