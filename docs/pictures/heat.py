"""The picture of a thermal camera beside the image of a video camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PIL import Image
from studio import beside, save

import morse
from morse.core.image_colors import as_heat

if TYPE_CHECKING:
    from pathlib import Path

SCENE = """
from morse.builder import *

robot = ATRV("robot")
robot.translate(-2.5, 0.0, 0.2)
robot.properties(Temperature=28.0)
for name, make in (("color", VideoCamera), ("heat", ThermalCamera)):
    camera = make(name)
    camera.properties(cam_width=640, cam_height=480, cam_focal=22.0, cam_far=100.0)
    camera.translate(x=0.8, z=1.2)
    camera.rotate(y=-0.15)
    robot.append(camera)
    if name == "heat":
        camera.properties(SkyTemperature=5.0)
        camera.noise(gaussian=0.3, field="image")

person = Victim("person")
person.translate(2.2, 1.3)
person.rotate(z=-1.2)
person.properties(Temperature=36.5)
other = Pioneer3DX("other")
other.translate(1.6, -0.6, 0.1)
other.rotate(z=2.5)
other.properties(Temperature=33.0)
standing = B21("standing")
standing.translate(4.2, -1.4, 0.1)
standing.properties(Temperature=26.0)
stove = Cube("Stove")
stove.location, stove.scale = (5.2, 0.6, 0.45), (0.45, 0.45, 0.45)
stove.set_color(0.5, 0.1, 0.05)
stove.properties(Temperature=48.0)
env = Environment("land-1/trees")
"""


def thermal(folder: Path) -> None:
    """A person, robots and a stove on a meadow, in colours and as temperatures."""
    script = folder / "heat.py"
    script.write_text(SCENE)
    with morse.load(script) as simulation:
        simulation.step(30)
        color = simulation.robot.color.data["image"][..., :3]
        save("thermal", [beside(Image.fromarray(color), Image.fromarray(as_heat(simulation.robot.heat.data["image"])))])
