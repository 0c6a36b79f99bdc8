#! /usr/bin/env python
"""Raw, differential and integrated odometry of a robot on two arcs."""

import math

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class OdometryTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(x=5.0, y=2.0)
        robot.rotate(z=math.pi / 2)
        motion = MotionVW()
        robot.append(motion)
        motion.add_stream("socket")
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        whole = Odometry()
        robot.append(whole)
        whole.add_stream("socket")
        raw = Odometry()
        raw.level("raw")
        raw.frequency(15)
        robot.append(raw)
        raw.add_stream("socket")
        diff = Odometry()
        diff.level("differential")
        diff.frequency(15)
        robot.append(diff)
        diff.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_level(self):
        with Morse() as morse:
            steps, turns = [], []
            morse.robot.raw.subscribe(lambda data: steps.append(data["dS"]))
            morse.robot.diff.subscribe(lambda data: turns.append((data["dx"], data["dyaw"])))
            start = morse.robot.whole.get()
            for name in ("x", "y", "yaw"):
                self.assertAlmostEqual(start[name], 0.0, delta=0.03)
            motion = morse.robot.motion
            motion.publish({"v": 1.0, "w": -math.pi / 4})
            morse.sleep(2.1)
            end = morse.robot.whole.get()
            radius = 4 / math.pi
            self.assertAlmostEqual(end["x"], radius, delta=0.1)
            self.assertAlmostEqual(end["y"], -radius, delta=0.1)
            self.assertAlmostEqual(end["yaw"], -math.pi / 2, delta=0.1)
            self.assertAlmostEqual(end["vx"], 1.0, delta=0.08)
            self.assertAlmostEqual(end["wz"], -math.pi / 4, delta=0.08)
            motion.publish({"v": 0.5, "w": -math.pi / 8})
            morse.sleep(12.1)
            motion.publish({"v": 0.0, "w": 0.0})
            morse.sleep(0.2)
            here = morse.robot.pose.get()
            self.assertAlmostEqual(here["x"], 5.0, delta=0.15)
            self.assertAlmostEqual(here["y"], 2.0, delta=0.15)
            self.assertAlmostEqual(sum(steps), 8.0, delta=0.6)
            self.assertAlmostEqual(sum(turn for _, turn in turns), -2 * math.pi, delta=0.15)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(OdometryTest)
