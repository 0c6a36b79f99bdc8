#! /usr/bin/env python
"""Simple and raw GPS."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class GPSTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        robot.translate(10.0, 8.0, 20.0)
        gps = GPS()
        robot.append(gps)
        gps.add_stream("socket")
        raw = GPS()
        raw.level("raw")
        robot.append(raw)
        raw.add_stream("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.properties(latitude="43.6", longitude=1.4333333, altitude=135.0)
        env.add_service("socket")

    def test_position(self):
        with Morse() as morse:
            here = morse.robot.gps.get()
            for name, value in (("x", 10.0), ("y", 8.0), ("z", 20.0)):
                self.assertAlmostEqual(here[name], value, delta=0.001)
            place = morse.robot.raw.get()
            self.assertAlmostEqual(place["latitude"], 43.6 + 8.0 / 111110.0, delta=1e-5)
            self.assertAlmostEqual(place["longitude"], 1.4333333 + 10.0 / 80740.0, delta=1e-5)
            self.assertAlmostEqual(place["altitude"], 155.0, delta=0.02)
            morse.robot.teleport.publish({"x": 0.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0})
            morse.sleep(0.05)
            # the origin is stored in single precision
            self.assertAlmostEqual(morse.robot.raw.get()["latitude"], 43.5999985, delta=1e-7)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(GPSTest)
