"""Pictures of what radar, sonar and event camera show, from real simulations.

python docs/pictures/senses.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

import morse

FOLDER = Path(__file__).parent


def water() -> None:
    """Describe a submarine before a wreck."""
    from morse.builder import Cube, Environment, ImagingSonar, MotionXYW, SideScanSonar, Sphere, Submarine

    ground = Cube("ground")
    ground.scale = (80, 80, 0.5)
    ground.translate(z=-20.5)
    ground.static()
    for index, (x, y, size) in enumerate(((10, 3, 1.2), (18, 9, 0.8), (22, -1, 1.0), (30, 5, 1.5))):
        rock = Sphere(f"rock{index}")
        rock.scale = (size, size, size)
        rock.translate(x, y, -19.7)
        rock.static()
    wreck = Cube("wreck")
    wreck.scale = (5, 1, 1.5)
    wreck.translate(15, -7, -19)
    wreck.rotate(z=0.4)
    wreck.static()
    boat = Submarine("boat")
    boat.translate(z=-16)
    motion, sonar, side = MotionXYW("motion"), ImagingSonar("sonar"), SideScanSonar("side")
    sonar.rotate(y=0.25)
    for part in (motion, sonar, side):
        boat.append(part)
    for sensor in (sonar, side):
        sensor.properties(errors=True)
    Environment("empty", fastmode=True)


def street() -> None:
    """Describe a car before other cars."""
    from morse.builder import ATRV, Cube, Environment, MotionVW, Radar

    car = ATRV("car")
    car.translate(z=0.2)
    motion, radar = MotionVW("motion"), Radar("radar")
    radar.translate(x=0.5, z=0.8)
    radar.properties(errors=True)
    car.append(motion)
    car.append(radar)
    road = Cube("road")
    road.scale = (200, 30, 0.5)
    road.translate(z=-0.5)
    road.static()
    for index, (x, y) in enumerate(((25, 4), (45, -4), (60, 4))):
        wall = Cube(f"wall{index}")
        wall.scale = (2, 1, 0.8)
        wall.translate(x, y, 0.8)
        wall.static()
    other = ATRV("other")
    other.translate(35, 0, 0.2)
    drive = MotionVW("drive")
    other.append(drive)
    Environment("empty", fastmode=True)


def room() -> None:
    """Describe a robot that turns in a room."""
    from morse.builder import ATRV, Environment, EventCamera, MotionVW

    robot = ATRV("robot")
    motion, eye = MotionVW("motion"), EventCamera("eye")
    eye.translate(x=0.6, z=1.2)
    robot.append(motion)
    robot.append(eye)
    Environment("sandbox").simulator_frequency(100)


def main() -> None:
    """Write the pictures side by side."""
    shown = []
    with morse.load(water, seed=1, sockets=False) as simulation:
        simulation.boat.motion.publish({"x": 1.0, "y": 0.0, "w": 0.0})
        simulation.sleep(25.0)
        shown += [simulation.context.components[f"boat.{name}"].shown()["image"] for name in ("sonar", "side")]
    with morse.load(street, seed=1, sockets=False) as simulation:
        simulation.car.motion.publish({"v": 8.0, "w": 0.0})
        simulation.other.drive.publish({"v": 14.0, "w": 0.0})
        simulation.sleep(1.0)
        shown.append(simulation.context.components["car.radar"].shown()["image"])
    with morse.load(room, seed=1, sockets=False) as simulation:
        simulation.robot.motion.publish({"v": 0.5, "w": 0.5})
        simulation.step(40)
        shown.append(simulation.context.components["robot.eye"].shown()["image"])
    height = 256
    images = [Image.fromarray(np.asarray(one, np.uint8)) for one in shown]
    images = [one.resize((round(one.width * height / one.height), height)) for one in images]
    whole = Image.new("RGB", (sum(one.width for one in images) + 8 * (len(images) - 1), height), "white")
    left = 0
    for one in images:
        whole.paste(one, (left, 0))
        left += one.width + 8
    whole.save(FOLDER / "senses.webp", quality=80)


if __name__ == "__main__":
    main()
