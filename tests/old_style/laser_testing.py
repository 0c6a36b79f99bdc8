#! /usr/bin/env python
"""A laser scanner in a closed room."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class LaserTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(-5.0, 2.0, 0.0)
        sick = Sick()
        sick.translate(x=0.18, z=0.94)
        sick.properties(resolution=1.0, scan_window="180.0", laser_range=30.0)
        robot.append(sick)
        sick.add_stream("socket")
        motion = MotionVW()
        robot.append(motion)
        motion.add_stream("socket")
        env = Environment("indoors-1/boxes", fastmode=True)
        env.add_service("socket")

    def test_scan(self):
        with Morse() as morse:
            sick, motion = morse.robot.sick, morse.robot.motion
            scan = sick.get()
            self.assertEqual(len(scan["range_list"]), 181)
            for distance, (x, y, z) in zip(scan["range_list"], scan["point_list"]):
                length = (x * x + y * y + z * z) ** 0.5
                self.assertTrue((length == 0.0 and distance == 30.0) or abs(length - distance) < 1e-3)
            before = scan["range_list"][90]
            motion.publish({"v": -1.0, "w": 0.0})
            morse.sleep(1.0)
            motion.publish({"v": 0.0, "w": 0.0})
            morse.sleep(0.2)
            after = sick.get()["range_list"][90]
            if before < 29.0:
                self.assertAlmostEqual(after - before, 1.0, delta=0.1)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(LaserTest)
