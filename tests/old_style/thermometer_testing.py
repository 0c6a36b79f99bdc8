#! /usr/bin/env python
"""The fire of the environment warms a thermometer."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class ThermometerTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        robot.translate(40.0, 0.0, 0.0)
        thermometer = Thermometer()
        robot.append(thermometer)
        thermometer.add_stream("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream("socket")
        env = Environment("land-1/rosace_1", fastmode=True)
        env.add_service("socket")

    def test_fire(self):
        with Morse() as morse:
            thermometer = morse.robot.thermometer
            self.assertAlmostEqual(thermometer.get()["temperature"], 15.0 + 3.66, delta=0.05)
            morse.robot.teleport.publish({"x": 50.0, "y": 0.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0})
            morse.sleep(0.1)
            self.assertAlmostEqual(thermometer.get()["temperature"], 15.0 + 200.0 * 2.718281828**-2.0, delta=0.1)

    def test_the_fire_grows(self):
        with Morse() as morse:
            thermometer = morse.robot.thermometer
            temperatures = [thermometer.get()["temperature"]]
            for _ in range(2):
                morse.sleep(2.0)
                temperatures.append(thermometer.get()["temperature"])
            self.assertTrue(temperatures[0] < temperatures[1] < temperatures[2], temperatures)
            self.assertAlmostEqual(temperatures[2], 15.0 + 3.66, delta=0.05)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(ThermometerTest)
