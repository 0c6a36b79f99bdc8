"""Pictures of each weather as the sensors show it, from real simulations.

python docs/pictures/weather.py
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import morse

FOLDER = Path(__file__).parent
#: what the columns show
WEATHERS: dict[str, dict[str, object]] = {
    "clear": {},
    "fog, 40 m": {"fog": 40.0},
    "rain, 40 mm/h": {"rain": 40.0, "wet": 0.8, "lens_drops": 10.0, "fog": 300.0},
    "snow, 4 mm/h": {"snow": 4.0, "snow_cover": 0.8},
    "dust": {"dust": 0.1},
    "a bank of fog": {"zone": "bank", "area": [(4.0, -40.0), (40.0, 40.0)], "height": 0.9, "fog": 10.0},
}
#: side of a picture, px
SIDE = 240


def describe(weather: dict[str, object]) -> None:
    """Describe a robot outdoors that looks at crates and a hot barrel."""
    from morse.builder import ATRV, VLP16, Cylinder, DepthVideoCamera, Environment, Radar, ThermalCamera, VideoCamera

    robot = ATRV("robot")
    robot.translate(-4.0, 1.0, 0.25)
    for name, make in (("camera", VideoCamera), ("depth", DepthVideoCamera), ("heat", ThermalCamera)):
        camera = make(name)
        camera.translate(x=0.4, z=0.9)
        camera.properties(cam_width=SIDE, cam_height=SIDE, cam_far=200.0)
        robot.append(camera)
    laser = VLP16("laser")
    laser.translate(z=1.0)
    laser.properties(resolution=0.5, laser_range=60.0)
    robot.append(laser)
    radar = Radar("radar")
    radar.translate(x=0.5, z=0.8)
    radar.properties(errors=True)
    robot.append(radar)
    barrel = Cylinder("barrel")
    barrel.scale = (0.6, 0.6, 1.2)
    barrel.translate(3.0, -1.0, 0.6)
    barrel.properties(Temperature=60.0)
    barrel.static()
    env = Environment("outdoors", fastmode=False)
    env.weather(**weather)


def main() -> None:
    """Draw a table of pictures: a column for each weather, a row for each sensor."""
    table = Image.new("RGB", (len(WEATHERS) * (SIDE + 4) - 4, 5 * (SIDE + 4) - 4), "white")
    for column, (name, weather) in enumerate(WEATHERS.items()):
        with morse.load(partial(describe, weather)) as sim:
            sim.step(70)
            sensors = sim.context.components
            rows = [
                np.asarray(sim.robot.camera.get()["image"])[..., :3],
                _distances(sensors["robot.depth"].top_first(np.asarray(sim.robot.depth.get()["image"]))),
                _heat(sensors["robot.heat"].top_first(np.asarray(sim.robot.heat.get()["image"]))),
                _plan(np.asarray(sim.robot.laser.get()["point_list"])),
                np.asarray(sensors["robot.radar"].shown()["image"]),
            ]
        for row, pixels in enumerate(rows):
            picture = Image.fromarray(np.ascontiguousarray(pixels[..., :3]).astype(np.uint8)).resize((SIDE, SIDE))
            if row == 0:
                draw = ImageDraw.Draw(picture)
                draw.rectangle((0, 0, SIDE, 17), fill="white")
                draw.text((4, 3), name, fill="black")
            table.paste(picture, (column * (SIDE + 4), row * (SIDE + 4)))
    table.save(FOLDER / "weather.webp", quality=82)


def _distances(depth: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        near = np.where(np.isfinite(depth) & (depth > 0), np.clip(1.0 - np.log(depth) / np.log(60.0), 0.05, 1.0), 0.0)
    return np.repeat((near * 255)[..., None], 3, axis=-1)


def _heat(celsius: np.ndarray) -> np.ndarray:
    warm = np.clip((celsius - 10.0) / 50.0, 0.0, 1.0)
    return np.stack([np.clip(3 * warm, 0, 1), np.clip(3 * warm - 1, 0, 1), np.clip(3 * warm - 2, 0, 1)], axis=-1) * 255


def _plan(points: np.ndarray) -> np.ndarray:
    """The points of a scan from above, 20 m to each side; those more than 0.3 m above the ground are bright."""
    pixels = np.zeros((SIDE, SIDE, 3))
    points = points[(np.abs(points) > 1e-6).any(axis=1)]
    points = points[np.argsort(points[:, 2])]
    spot = ((points[:, :2] / 40.0 + 0.5) * SIDE).astype(int)
    inside = ((spot >= 0) & (spot < SIDE)).all(axis=1)
    high = (points[inside, 2] > -0.7)[:, None]
    pixels[SIDE - 1 - spot[inside, 0], SIDE - 1 - spot[inside, 1]] = np.where(high, (120, 230, 255), (40, 90, 130))
    return pixels


if __name__ == "__main__":
    main()
