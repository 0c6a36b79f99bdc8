#! /usr/bin/env python
"""A lamp on a robot lights a box."""

import base64

from morse.testing.testing import MorseTestCase, main
from pymorse import Morse


class LightTest(MorseTestCase):
    def setUpEnv(self):
        robot = ATRV()
        robot.translate(x=-8.8, y=6.0)
        light = Light()
        light.translate(z=0.9)
        light.properties(emit=False)
        light.add_stream("socket")
        light.add_service("socket")
        robot.append(light)
        camera = VideoCamera()
        camera.translate(z=0.9)
        camera.properties(cam_width=320, cam_height=240, cam_focal=25.0, capturing=True)
        camera.add_stream("socket")
        robot.append(camera)
        env = Environment("indoors-1/boxes")
        env.add_service("socket")

    def _green(self, morse):
        morse.sleep(0.3)
        image = morse.robot.camera.get()["image"]
        pixels = base64.b64decode(image)
        return sum(r < 10 and g > 170 and b < 30 for r, g, b in zip(pixels[::4], pixels[1::4], pixels[2::4]))

    def test_lit(self):
        with Morse() as morse:
            self.assertEqual(self._green(morse), 0)
            morse.robot.light.publish({"emit": True})
            self.assertGreater(self._green(morse), 7000)
            morse.robot.light.toggle(False).result()
            self.assertEqual(self._green(morse), 0)


########################## Run these tests ##########################
if __name__ == "__main__":
    main(LightTest)
