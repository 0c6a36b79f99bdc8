"""Tests of your own simulations.

As `unittest` cases, in the style of MORSE 1.4 (`morse.testing.testing`)::

    from morse.testing.testing import MorseTestCase, main
    from pymorse import Morse

    class Stands(MorseTestCase):
        def setUpEnv(self):
            robot = ATRV()
            pose = Pose()
            robot.append(pose)
            robot.add_default_interface("socket")
            env = Environment("empty")

        def test_it_stands(self):
            with Morse() as simu:
                self.assertAlmostEqual(simu.robot.pose.get()["z"], 0.10, delta=0.01)

    if __name__ == "__main__":
        main(Stands)

or as pytest functions with the fixture of `morse.testing.fixtures`.
"""
