#! /usr/bin/env python
"""An IMU at rest, and on a robot that turns and pitches."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class IMUTest(MorseTestCase):
    def setUpEnv(self):
        robot = RMax()
        robot.translate(z=10.0)
        imu = IMU()
        robot.append(imu)
        imu.add_stream("socket")
        orientation = Orientation()
        orientation.properties(speed=0.5)
        robot.append(orientation)
        orientation.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.properties(longitude=1.26, latitude=43.6, altitude=130.0)
        env.add_service("socket")

    def test_rates(self):
        with Morse() as morse:
            imu, orientation = morse.robot.imu, morse.robot.orientation
            still = imu.get()
            for value, expected in zip(still["linear_acceleration"], (0.0, 0.0, 9.81)):
                self.assertAlmostEqual(value, expected, delta=0.01)
            for value in still["angular_velocity"]:
                self.assertAlmostEqual(value, 0.0, delta=0.001)
            north, east, down = still["magnetic_field"]
            self.assertTrue(22000 < north < 25000 and -2000 < east < 2000 and 35000 < down < 45000)
            orientation.publish({"yaw": 1.0, "pitch": 1.0, "roll": 0.0})
            imu.get()
            imu.get()
            for _ in range(5):
                for value, expected in zip(imu.get()["angular_velocity"], (0.0, 0.5, 0.5)):
                    self.assertAlmostEqual(value, expected, delta=0.003)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(IMUTest)
