"""Weather, beside recommendations and papers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from figures import Figure, scene

from morse.plugins.weather.medium import VISIBLE, Conditions, drops_of, falling_speed
from morse.plugins.weather.radio import LIGHT, attenuation, attenuation_of_sound, echo_of_rain
from morse.plugins.weather.services import outputs, turbulence
from morse.rendering.textures import LINEAR

if TYPE_CHECKING:
    from collections.abc import Iterator

#: the light of an overcast sky, in codes
SKY = (196, 200, 204)
WALL = """
robot = FakeRobot()
camera = VideoCamera()
camera.translate(z=1.0)
camera.properties(cam_width=64, cam_height=64, cam_far=400.0)
robot.append(camera)
wall = Cube("wall")
wall.scale = (0.5, 200.0, 200.0)
wall.translate(x=50.5)
env = Environment("empty")
"""
CRATE = """
crate = Cube("crate")
crate.scale = (0.5, 0.5, 0.25)
crate.translate(z=0.25)
crate.set_rigid_body()
robot = FakeRobot()
robot.translate(y=9.0)
env = Environment("empty")
env.weather(wet=1.0)
"""


def figures() -> Iterator[Figure]:
    """Measure the weather."""
    for rate, decibels in ((12.0, 5.687), (50.0, 14.79)):
        loss = 10.0 * math.log10(math.exp(Conditions(rain=rate).extinction(VISIBLE) * 1000.0))
        yield Figure(f"rain of {rate:g} mm/h", "loss of light, dB/km", decibels, loss, 0.05, "ITU-R P.1814")
    for gigahertz, k, alpha in ((24.0, 0.1425, 1.0101), (80.0, 1.1704, 0.7115)):
        radio, loss = attenuation(Conditions(rain=10.0), gigahertz * 1e9), k * 10.0**alpha
        what = f"loss at {gigahertz:g} GHz, dB/km"
        yield Figure("rain of 10 mm/h", what, loss, radio, 0.005, "ITU-R P.838-3, table 5")
    for rate in (5.0, 25.0):
        expected = 10.0 * math.log10(math.pi**5 * 0.93 * 200.0 * rate**1.6 * 1e-18 / (LIGHT / 9.4e9) ** 4)
        echo = 10.0 * math.log10(echo_of_rain(Conditions(rain=rate), 9.4e9))
        source = "π⁵ |K|² Z / λ⁴, Z = 200 R^1.6; Battan"
        yield Figure(f"rain of {rate:g} mm/h at 9.4 GHz", "radar echo, dB(m²/m³)", expected, echo, 1.5, source)
    for frequency, celsius, loss in ((1000.0, 20.0, 5.0), (4000.0, 20.0, 22.9), (2000.0, 10.0, 9.7)):
        what = f"sound of {frequency:g} Hz at {celsius:g} °C, 70 %"
        fades = 1000.0 * attenuation_of_sound(frequency, celsius, 0.7)
        yield Figure(what, "loss, dB/km", loss, fades, 0.3, "ISO 9613-2, table 2")
    (drops,) = drops_of(Conditions(rain=12.0))
    diameters = np.linspace(0.0, 8.0, 4001)
    density = drops.intercept * np.exp(-drops.slope * diameters)
    speeds = np.array([falling_speed(diameter) for diameter in diameters])
    flux = float(np.sum(density * np.pi / 6.0 * (1e-3 * diameters) ** 3 * speeds) * 0.002 * 3.6e6)
    yield Figure("rain of 12 mm/h", "water that its drops carry, mm/h", 12.0, flux, 2.0, "Marshall, Palmer; Atlas")
    yield Figure("fog of 100 m", "contrast of a wall at 50 m", math.exp(-1.498), _contrast(), 0.01, "Koschmieder")
    yield from _gusts()
    yield Figure("crate on wet ground", "deceleration, m/s²", 0.35 * 9.81, _deceleration(), 0.15, "half of μ g")


def _contrast() -> float:
    light = []
    for weather in ("", "env.weather(fog=100.0)"):
        with scene(WALL + weather) as sim:
            sim.step(12)
            codes = np.asarray(sim.robot.camera.get()["image"])[32, 32, :3]
            light.append(LINEAR[codes] - LINEAR[list(SKY)])
    return float(np.mean(light[1] / light[0]))


def _gusts() -> Iterator[Figure]:
    filters, series = np.zeros(5), []
    for white in np.random.default_rng(1).standard_normal((200_000, 3)):
        filters = turbulence(filters, white, 0.05, 20.0)
        series.append(outputs(filters))
    for name, deviation in zip(("along the wind", "across", "upward"), np.std(series, axis=0), strict=True):
        yield Figure(f"gusts {name}", "standard deviation", 1.0, float(deviation), 0.06, "MIL-F-8785C, Dryden")


def _deceleration() -> float:
    with scene(CRATE) as sim:
        sim.step(30)
        body = sim.context.world.objects_by_name["crate"]
        body.worldLinearVelocity = (2.0, 0.0, 0.0)
        before = body.worldLinearVelocity.x
        sim.step(20)
        return float((before - body.worldLinearVelocity.x) / (20 * sim.context.clock.period))
