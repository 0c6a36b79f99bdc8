"""Radar, sonar and other senses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from figures import Figure, scene

from morse.plugins.senses.sensors.radar import LIGHT, doppler_shift
from morse.plugins.senses.water import absorption, sound_speed

if TYPE_CHECKING:
    from collections.abc import Iterator

_RADAR = """
robot = FakeRobot("robot")
robot.translate(z=5.0)
radar = Radar()
radar.properties(elevation_fov=2.0)
robot.append(radar)
target = Empty("target")
target.translate({x}, 0.0, 5.0)
target.properties({what})
env = Environment("empty")
"""
_GROUND = """
robot = FakeRobot("robot")
robot.translate(z=0.9)
radar = Radar()
radar.properties(elevation_fov=6.0, carrier=24e9, ground_reflection=1.0)
robot.append(radar)
ground = Cube("ground"); ground.scale = (200, 200, 0.5); ground.translate(z=-0.5); ground.static()
target = Empty("target")
target.translate(60.0, 0.0, {z})
target.properties(radar_cross_section=1e4)
env = Environment("empty")
"""
_WATER = """
ground = Cube("ground"); ground.scale = (100, 100, 0.5); ground.translate(z=-20.5); ground.static()
robot = Submarine("robot")
robot.translate(z=-16.0)
motion = MotionXYW()
robot.append(motion)
log, depth, bottom = DVL(), EchoSounder(), MultibeamSonar()
bottom.properties(gradient=-2.0)
for sensor in (log, depth, bottom):
    robot.append(sensor)
env = Environment("empty")
"""


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    yield from radar()
    yield from water()
    yield from sources()


def radar() -> Iterator[Figure]:
    """The radar equation, a corner reflector, the Doppler shift."""
    shift = doppler_shift(-10.0, 77e9)
    yield Figure("radar, 77 GHz, 10 m/s", "Doppler shift, Hz", 5137.0, shift, 0.5, "2 v f / c")
    with scene(_RADAR.format(x=20.0, what="radar_corner=0.2")) as sim:
        sim.step(3)
        found = sim.robot.radar.data["detections"][0]
    expected = 4.0 * math.pi * 0.2**4 / (3.0 * (LIGHT / 77e9) ** 2)
    yield Figure("radar, trihedral corner of 0.2 m", "cross-section, m²", expected, found["rcs"], 0.1, "4π a⁴ / 3λ²")
    peaks = []
    size = LIGHT / 2.0 / 96e6
    for cell in (10.5, 31.5):
        with scene(_RADAR.format(x=cell * size, what="radar_cross_section=10.0")) as sim:
            sim.step(3)
            peaks.append(10.0 ** (float(np.max(sim.robot.radar.data["map"])) / 10.0) - 1.0)
    yield Figure("radar, target at 16.4 and 49.2 m", "ratio of the powers", 81.0, peaks[0] / peaks[1], 0.8, "r⁻⁴")
    for height in (0.15, 0.6):
        with scene(_GROUND.format(z=height)) as sim:
            sim.step(3)
            share = sim.robot.radar.data["detections"][0]["rcs"] / 1e4
        expected = 16.0 * math.sin(2.0 * math.pi * height * 0.9 * 24e9 / (LIGHT * 60.0)) ** 4
        what = f"radar at 0.9 m, target at {height} m, 60 m away, over ground"
        yield Figure(what, "share of the power in free space", expected, share, 0.05, "16 sin⁴(2π h_t h_r / λ d)")


def water() -> Iterator[Figure]:
    """Sound in water, and what measures by it."""
    speed = sound_speed(25.0, 35.0, 1000.0)
    yield Figure("speed of sound, 25 °C, 35 ‰, 1000 m", "m/s", 1550.744, speed, 0.0005, "Mackenzie 1981")
    fresh = absorption(500e3, 10.0, 1e-9) * 1000.0
    viscous = 0.00049 * 500.0**2 * math.exp(-10.0 / 27.0)
    yield Figure("absorption, fresh water, 500 kHz", "dB/km", viscous, fresh, 0.5, "Ainslie and McColm 1998")
    with scene(_WATER) as sim:
        sim.robot.motion.publish({"x": 1.0, "y": 0.3, "w": 0.0})
        sim.sleep(0.5)
        log, depth = sim.robot.log.data, sim.robot.depth.data["depth"]
        measured = float(sim.robot.bottom.data["ranges"][0])
    yield Figure("Doppler log, 1 m/s ahead", "velocity, m/s", 1.0, log["velocity"][0], 1e-3, "its velocity")
    yield Figure("Doppler log, 4 m above ground", "altitude, m", 4.0, log["altitude"], 1e-3, "its height")
    yield Figure("echo sounder, 4 m above ground", "depth, m", 4.0, depth, 1e-3, "its height")
    yield Figure(
        "multibeam sonar, outer beam, −2 /s", "range, m", *_snell(-2.0), measured, 2e-3, "Snell's law, integrated"
    )


def _snell(gradient: float) -> tuple[float]:
    """The range by the time along a bent ray down to 4 m, m."""
    angle = math.radians(60.0) * 255.0 / 256.0
    speed = sound_speed(10.0, 35.0, 16.0)
    time, steps = 0.0, 20_000
    for index in range(steps):
        now = speed + gradient * 4.0 * (index + 0.5) / steps
        time += 4.0 / steps / math.sqrt(1.0 - (math.sin(angle) * now / speed) ** 2) / now
    return (time * speed,)


_SOURCES = """
robot = FakeRobot("robot")
robot.translate(z=1.0)
counter, ear, nose, anchors = GeigerCounter(), Microphone(), GasSensor(), UWB()
counter.properties(background=0.0)
ear.properties(floor=-20.0)
nose.properties(turbulence=0.0, interval=0.02, lifetime=25.0)
for sensor in (counter, ear, nose, anchors):
    robot.append(sensor)
source = Empty("source")
source.translate({x}, 0.0, 1.0)
source.properties(activity=1e6, sound_level=80.0, gas_source=2.0, uwb_anchor=True)
if {wall}:
    wall = Cube("wall")
    wall.scale = (0.1, 5, 5)
    wall.translate({x} / 2, 0, 1)
    wall.properties(attenuation=12.0, permittivity=6.25)
    wall.static()
env = Environment("empty", fastmode=True)
env.properties(wind_x=1.0)
"""


def sources() -> Iterator[Figure]:
    """Radiation, sound, gas and the bias of UWB."""
    found = {}
    for x, wall in ((-4.0, False), (-8.0, False), (-4.0, True)):
        with scene(_SOURCES.format(x=x, wall=wall)) as sim:
            sim.step(1800 if (x, wall) == (-4.0, False) else 6)
            robot = sim.robot
            found[x, wall] = (
                robot.counter.data["rate"],
                robot.ear.data["level"],
                robot.nose.data["concentration"],
                robot.anchors.data["ranges"][0]["range"],
            )
    near, far, behind = found[-4.0, False], found[-8.0, False], found[-4.0, True]
    yield Figure("Geiger counter, 4 and 8 m", "ratio of the rates", 4.0, near[0] / far[0], 1e-6, "r⁻²")
    shield = math.exp(-12.0 * 0.2)
    yield Figure("Geiger counter, shield of 0.2 m", "share", shield, behind[0] / near[0], 1e-6, "exp(−μ d)")
    yield Figure("microphone, 4 and 8 m", "difference, dB", 20 * math.log10(2.0), near[1] - far[1], 1e-3, "20 log r")
    plume = 2.0 / (4.0 * math.pi * 0.05 * 4.0)
    yield Figure("gas, 4 m downwind of 2 g/s", "g/m³", plume, near[2], 0.02, "Q / 4πDr")
    yield Figure("UWB, wall of 0.2 m, ε = 6.25", "bias, m", 0.3, behind[3] - near[3], 1e-6, "(√ε − 1) d")
