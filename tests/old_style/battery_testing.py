#! /usr/bin/env python
"""A battery discharges, and is charged in a zone."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class BatteryTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        battery = Battery()
        battery.properties(DischargingRate="10.0")
        robot.append(battery)
        battery.add_stream("socket")
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream("socket")
        zone = Zone(type="Charging")
        zone.size = [2.0, 2.0, 2.0]
        zone.translate(x=10.0)
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_charge(self):
        with Morse() as morse:
            battery = morse.robot.battery
            first = battery.get()
            morse.sleep(2.0)
            second = battery.get()
            passed = second["timestamp"] - first["timestamp"]
            self.assertAlmostEqual(second["charge"], first["charge"] - 10.0 * passed, delta=0.3)
            morse.robot.teleport.publish({"x": 10.0, "y": 0.0, "z": 0.1, "yaw": 0.0, "pitch": 0.0, "roll": 0.0})
            morse.sleep(0.2)
            low = battery.get()["charge"]
            morse.sleep(1.0)
            self.assertGreater(battery.get()["charge"], low + 8.0)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(BatteryTest)
