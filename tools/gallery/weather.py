"""Creates the picture of the documentation of the weather: ``python tools/gallery/weather.py``."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import morse

TARGET = Path(__file__).parents[2] / "docs" / "pictures" / "weather.webp"
SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(x=-14.0, y=-6.0, z=2.0)
camera = VideoCamera()
camera.properties(cam_width=320, cam_height=240, cam_fov=70.0, cam_far=500.0, exposure_time=0.02)
robot.append(camera)
car = Hummer()
car.translate(x=-6.0, y=-6.5, z=1.8)
env = Environment("outdoors")
{}
"""
WEATHER = ("", "fog=25.0", "rain=80.0, fog=400.0", "snow=12.0, fog=200.0", "dust=0.08")


def main() -> None:
    """Take the pictures, side by side."""
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        for weather in WEATHER:
            script = Path(folder) / "scene.py"
            script.write_text(SCENE.format(f"env.weather({weather})" if weather else ""))
            with morse.load(script) as simulation:
                simulation.step(30)
                pictures.append(np.asarray(simulation.robot.camera.get()["image"])[..., :3])
    Image.fromarray(np.hstack(pictures)).save(TARGET, quality=85)


if __name__ == "__main__":
    main()
