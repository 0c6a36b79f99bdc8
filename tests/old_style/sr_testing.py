#! /usr/bin/env python
"""A victim is found and healed."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class RescueTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        robot.translate(z=0.8)
        sensor = SearchAndRescue()
        sensor.properties(Abilities="1,2,3")
        robot.append(sensor)
        sensor.add_stream("socket")
        sensor.add_service("socket")
        victim = Victim()
        victim.translate(x=1.5)
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_heal(self):
        with Morse() as simu:
            sensor = simu.robot.sensor
            self.assertEqual(sensor.get()["victim_dict"]["victim"]["severity"], 10)
            self.assertEqual(sensor.get_victim_requirements().result(), [1, 2, 3])
            sensor.heal().result()
            sensor.get()
            healed = sensor.get()["victim_dict"]["victim"]
            self.assertEqual(healed["requirements"], [])
            self.assertEqual(healed["severity"], 0)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(RescueTest)
