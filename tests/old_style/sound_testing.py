#! /usr/bin/env python
"""A sound is played and stopped."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class SoundTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        sound = Sound()
        robot.append(sound)
        sound.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_modes(self):
        with Morse() as simu:
            for mode in ("play", "pause", "stop"):
                simu.robot.sound.publish({"mode": mode})
                simu.sleep(0.1)
            self.assertTrue(simu.is_up())


########################## Run these tests ##########################
if __name__ == "__main__":
    main(SoundTest)
