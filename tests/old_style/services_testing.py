#! /usr/bin/env python
"""Services of the simulation: communication and time."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class ServicesTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        other = ATRV()
        other.translate(x=10.0)
        pose = Pose()
        robot.append(pose)
        pose.add_stream("socket")
        env = Environment("empty", fastmode=True)
        env.add_interface("socket")
        env.add_stream("socket")

    def test_communication(self):
        with Morse() as simu:
            distance, sight = simu.rpc("communication", "distance_and_view", "robot", "other")
            self.assertAlmostEqual(distance, 10.0, delta=0.05)
            self.assertTrue(sight)
            self.assertEqual(sorted(simu.rpc("simulation", "list_robots")), ["other", "robot"])

    def test_time(self):
        with Morse() as simu:
            pose = simu.robot.pose
            pose.get()
            before = simu.time()
            simu.sleep(1.0)
            # the messages of the time at which a sleep ends come after its end
            last = pose.last()["timestamp"]
            after = simu.time()
            self.assertAlmostEqual(after - before, 1.0, delta=0.1)
            self.assertLessEqual(last, after + 0.001)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(ServicesTest)
