#! /usr/bin/env python
"""Objects in the view of a camera."""

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class SemanticCameraTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(-4.7, 0.0, 0.0)
        robot.rotate(z=math.pi)
        camera = SemanticCamera()
        camera.translate(x=0.6, z=0.9)
        camera.properties(relative="True")
        robot.append(camera)
        camera.add_stream("socket")
        other = SemanticCamera()
        other.translate(x=0.6, z=0.9)
        other.properties(tag="Box")
        robot.append(other)
        other.add_stream("socket")
        env = Environment("indoors-1/boxes")
        env.add_service("socket")

    def test_box(self):
        with Morse() as simu:
            seen = simu.robot.camera.get()["visible_objects"]
            self.assertIn("RedBox", [thing["name"] for thing in seen])
            (red,) = [thing for thing in seen if thing["name"] == "RedBox"]
            x, _, z = red["position"]
            self.assertAlmostEqual(x, 0.0, delta=0.2)
            self.assertAlmostEqual(z, 2.2, delta=0.3)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(SemanticCameraTest)
