#! /usr/bin/env python
"""The joints and the tip of a KUKA arm."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class KukaTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        arm = KukaLWR()
        robot.append(arm)
        arm.add_stream("socket")
        arm.add_service("socket")
        tip = Pose()
        arm.append(tip)
        tip.add_stream("socket")
        state = ArmaturePose()
        arm.append(state)
        state.add_stream("socket")
        state.add_service("socket")
        arm.create_ik_targets(["kuka_7"])
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_tip(self):
        with Morse() as simu:
            arm, tip = simu.robot.arm, simu.robot.arm.tip
            here = tip.get()
            self.assertAlmostEqual(here["z"], 1.3105, delta=0.01)
            self.assertEqual(len(simu.robot.arm.state.get_joints_length().result()), 7)
            arm.set_rotations([0.0, 1.57, 0.0, 0.0, 0.0, 0.0, 0.0]).result()
            simu.sleep(0.1)
            self.assertAlmostEqual(abs(tip.last()["x"]), 1.0, delta=0.02)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(KukaTest)
