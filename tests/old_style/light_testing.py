#! /usr/bin/env python
"""A light brightens a green box before the camera."""

import base64

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class LightTest(MorseTestCase):
    def setUpEnv(self):
        robot = FakeRobot()
        robot.translate(z=1.0)
        camera = VideoCamera()
        camera.properties(cam_width=320, cam_height=240, cam_focal=25.0, Vertical_Flip=True)
        robot.append(camera)
        camera.add_stream("socket")
        light = Light()
        robot.append(light)
        light.add_service("socket")
        box = Cube("box")
        box.scale = (0.5, 0.5, 0.5)
        box.translate(2.3, 0.0, 1.0)
        box.color(0.0, 0.95, 0.02)
        env = Environment("empty")
        env.add_service("socket")

    def green(self, simu):
        simu.sleep(0.3)
        image = simu.robot.camera.get()["image"]
        pixels = base64.b64decode(image)
        return sum(1 for i in range(0, len(pixels), 4) if pixels[i] < 10 and pixels[i + 1] > 170 and pixels[i + 2] < 30)

    def test_light(self):
        with Morse() as simu:
            simu.robot.camera.get()
            self.assertGreater(self.green(simu), 7000)
            simu.robot.light.toggle(False).result()
            self.assertEqual(self.green(simu), 0)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(LightTest)
