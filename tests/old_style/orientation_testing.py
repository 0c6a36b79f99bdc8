#! /usr/bin/env python
"""The orientation of a robot, at once and at a speed."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class OrientationTest(MorseTestCase):
    def setUpEnv(self):
        robot = RMax()
        robot.translate(z=5.0)
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        orientation = Orientation()
        robot.append(orientation)
        orientation.add_stream("socket")
        slow = RMax()
        slow.translate(x=10.0, z=5.0)
        seen = Pose()
        slow.append(seen)
        seen.add_stream("socket")
        turn = Orientation()
        turn.properties(speed=0.5)
        slow.append(turn)
        turn.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_orientation(self):
        with Morse() as morse:
            pose, seen = morse.robot.pose, morse.slow.seen
            morse.robot.orientation.publish({"yaw": 1.0, "pitch": 0.3, "roll": -0.2})
            morse.slow.turn.publish({"yaw": 1.0, "pitch": 0.0, "roll": 0.0})
            morse.sleep(0.1)
            for name, value in (("yaw", 1.0), ("pitch", 0.3), ("roll", -0.2), ("x", 0.0), ("z", 5.0)):
                self.assertAlmostEqual(pose.last()[name], value, delta=0.001)
            before = seen.last()
            morse.sleep(1.0)
            after = seen.last()
            passed = after["timestamp"] - before["timestamp"]
            self.assertAlmostEqual(after["yaw"] - before["yaw"], 0.5 * passed, delta=0.01)
            morse.sleep(2.0)
            self.assertAlmostEqual(seen.last()["yaw"], 1.0, delta=0.021)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(OrientationTest)
