"""Creates the picture of the documentation of doors and lifts: ``python tools/gallery/facilities.py``."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image

import morse

TARGET = Path(__file__).parents[2] / "docs" / "pictures" / "facilities.webp"
SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(x=4.2, y=0.2, z=0.2)
lift = Lift(levels=(0.0, 3.5))
door = Door(kind="hinged")
door.translate(x=2.0, y=4.0)
sliding = Door(kind="sliding")
sliding.translate(x=2.0, y=6.0)
automatic = Door(kind="double", width=1.8, automatic=2.0)
automatic.translate(x=6.0)
for number, (y, width) in enumerate(((2.6, 1.4), (5.0, 0.5), (7.6, 1.3))):
    wall = Cube(f"wall {number}")
    wall.scale = (0.1, width / 2.0, 1.2)
    wall.translate(x=2.0, y=y, z=1.2)
    wall.set_physics_type("STATIC")
crowd = Crowd("crowd", 6)
crowd.start([(3.5, 3.0), (6.0, 7.0)])
crowd.goals([(-3.0, 4.0)])
env = Environment("empty")
env.set_camera_location([10.5, -4.0, 4.2])
env.set_camera_rotation([1.2, 0.0, 0.98])
"""


def main() -> None:
    """Take the picture."""
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "scene.py"
        script.write_text(SCENE)
        with morse.load(script) as simulation:
            simulation.lift.call(0)
            simulation.door.open()
            simulation.step(110)
            Image.fromarray(simulation.picture(900, 500)[..., :3]).save(TARGET, quality=85)


if __name__ == "__main__":
    main()
