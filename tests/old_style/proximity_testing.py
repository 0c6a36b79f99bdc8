#! /usr/bin/env python
"""Objects with a property within a range."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class ProximityTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(z=0.1)
        proximity = Proximity()
        proximity.properties(Range=5.0, Track="Catch_me")
        robot.append(proximity)
        proximity.add_stream("socket")
        proximity.add_service("socket")
        for i, place in enumerate((3.0, 7.0)):
            target = ATRV("Target%d" % i)
            target.properties(Catch_me="True")
            target.translate(x=place)
        env = Environment("empty", fastmode=True)

    def test_range(self):
        with Morse() as morse:
            proximity = morse.robot.proximity
            near = proximity.get()["near_objects"]
            self.assertEqual(list(near), ["Target0"])
            self.assertAlmostEqual(near["Target0"], 3.0, delta=0.05)
            proximity.set_range(10.0).result()
            proximity.get()
            self.assertEqual(sorted(proximity.get()["near_objects"]), ["Target0", "Target1"])
            proximity.set_tracked_tag("Nothing").result()
            proximity.get()
            self.assertEqual(proximity.get()["near_objects"], {})


########################## Run these tests ##########################
if __name__ == "__main__":
    main(ProximityTest)
