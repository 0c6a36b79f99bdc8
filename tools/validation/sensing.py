"""Laser scanner, inertial unit, GPS, magnetometer and barometer."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from figures import Figure, scene

from morse.core.kinds.binding import bind
from morse.helpers.geodesy import LocalPlane
from morse.sensors.magnetometer import DEFAULT_YEAR, MagneticField

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_G = 9.80665


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    yield ranges()
    yield from inertial()
    yield from on_the_earth()
    yield from compass()
    yield from pressure()


def ranges() -> Figure:
    """The largest error of 181 rays at a wall 3 m ahead."""
    text = """
robot = FakeRobot()
robot.translate(0, 0, 1)
scan = Sick()
scan.properties(laser_range=30.0, resolution=0.5, scan_window=90.0)
robot.append(scan)
wall = Cube("wall")
wall.location = (4, 0, 1)
wall.scale = (1, 10, 1)
wall.static()
env = Environment('empty', fastmode=True)
"""
    with scene(text) as sim:
        sim.step(2)
        data = sim.context.component("robot.scan")
        here, turn = data.bge_object.world_pose()
        axes = np.reshape(turn, (3, 3))
        worst = 0.0
        for x, y, z in data.local_data["point_list"]:
            point = axes @ (x, y, z) + here
            worst = max(worst, abs(float(point[0]) - 3.0))
    return Figure("laser scanner, 181 rays at a wall", "largest error, m", 0.0, worst, 1e-5, "the plane x = 3 m")


def allan(values: NDArray[np.float64], period: float, time: float) -> float:
    """The overlapping Allan deviation of a rate at a time (IEEE Std 952-1997)."""
    count = round(time / period)
    angle = np.concatenate([[0.0], np.cumsum(values)]) * period
    second = angle[2 * count :] - 2.0 * angle[count:-count] + angle[: -2 * count]
    return float(math.sqrt(np.mean(second**2) / (2.0 * time**2)))


def record(seconds: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angular velocity and specific force of a BMI088 at rest, sixty times per second."""
    text = "robot = FakeRobot()\nimu = BMI088()\nrobot.append(imu)\nenv = Environment('empty', fastmode=True)"
    with scene(text) as sim:
        data = sim.context.component("robot.imu").local_data
        gyro, force = [], []
        for _ in range(60 * seconds):
            sim.step(1)
            gyro.append(list(data["angular_velocity"]))
            force.append(list(data["linear_acceleration"]))
    return np.array(gyro), np.array(force)


@cache
def _recorded() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return record(200)


def deviations() -> list[tuple[float, float]]:
    """Times, s, and Allan deviations of the gyroscope of a BMI088, deg/s."""
    gyro, _ = _recorded()
    times = [2.0**k / 60.0 for k in range(12)]
    return [(time, math.degrees(allan(gyro[:, 0], 1 / 60, time))) for time in times]


def inertial() -> Iterator[Figure]:
    """The Allan deviation of a BMI088 at 1 s."""
    gyro, force = _recorded()
    sheet = "data sheet of the BMI088"
    turning = math.degrees(allan(gyro[:, 0], 1 / 60, 1.0))
    yield Figure("IMU BMI088, gyroscope", "Allan deviation at 1 s, °/s", 0.014, turning, 2e-3, sheet)
    for axis, expected in zip("XYZ", (160.0, 160.0, 190.0), strict=True):
        measured = allan(force[:, "XYZ".index(axis)], 1 / 60, 1.0) / _G * 1e6
        yield Figure(f"IMU BMI088, accelerometer {axis}", "Allan deviation at 1 s, µg", expected, measured, 20.0, sheet)
    yield Figure(
        "IMU BMI088, at rest", "mean specific force, m/s²", 9.81, float(force[:, 2].mean()), 1e-3, "g of the scene"
    )


def on_the_earth() -> Iterator[Figure]:
    """Values of test points of the World Magnetic Model."""
    text = """
robot = FakeRobot()
field = Magnetometer()
field.properties(date=2015.0)
robot.append(field)
env = Environment('empty', fastmode=True)
env.properties(longitude=0.0, latitude=80.0, altitude=0.0)
"""
    with scene(text) as sim:
        sim.step(2)
        data = sim.context.component("robot.field").local_data
        values = [float(data[axis]) for axis in "xyz"]
    source = "test values of the WMM2015, NOAA/NCEI and BGS"
    for name, expected, measured in zip(("north", "east", "down"), (6627.1, -445.9, 54432.3), values, strict=True):
        yield Figure("magnetic field at 80° N, 2015.0", f"{name}, nT", expected, measured, 0.1, source)


def compass() -> Iterator[Figure]:
    """The largest errors of what says where north is, once around a circle, in a world that is turned."""
    turned = 0.7
    text = f"""
robot = FakeRobot()
motion = MotionVW()
robot.append(motion)
gps = GPS()
gps.level("extended")
robot.append(gps)
field = Magnetometer()
robot.append(field)
attitude = Attitude()
attitude.properties(UseAngleAgainstNorth=True)
robot.append(attitude)
env = Environment('empty', fastmode=True)
env.properties(longitude=7.6, latitude=46.9, altitude=540.0, angle_against_north={turned})
"""
    place = LocalPlane(7.6, 46.9, 540.0)
    north, east, _ = MagneticField(place, DEFAULT_YEAR, None).north_east_down((0.0, 0.0, 0.0))
    names = ("GPS, heading", "magnetometer, message in the axes of the sensor", "attitude, yaw against east")
    worst = dict.fromkeys(names, 0.0)
    with scene(text) as sim:
        (magnetic,) = [
            kind for kind in bind(sim.context.component("robot.field")) if kind.kind.name == "magnetic_field"
        ]
        sim.robot.motion.publish({"v": 2.0, "w": 1.0})
        for _ in range(16):
            sim.step(24)
            ahead = sim.world.game_object("robot").world_pose()[1]
            x, y, _ = LocalPlane(7.6, 46.9, 540.0, turned).enu_of((ahead[0], ahead[3], 0.0))
            field = magnetic.gather().field
            # the mean course of the last tick of a circle is half of its turn behind the heading, which decreases
            course = math.radians(sim.robot.gps.data["heading"]) - 0.5 / 60.0
            bearings = (
                course,
                math.atan2(field[1], field[0]) + math.atan2(east, north),
                math.pi / 2.0 - float(sim.context.component("robot.attitude").local_data["rotation"][2]),
            )
            for name, bearing in zip(names, bearings, strict=True):
                worst[name] = max(worst[name], abs(math.remainder(bearing - math.atan2(x, y), math.tau)))
    for name in names:
        source = "angle of the X axis from north, clockwise"
        yield Figure(
            f"once around the compass: {name}", "largest error, °", 0.0, math.degrees(worst[name]), 0.1, source
        )


def pressure() -> Iterator[Figure]:
    """The standard atmosphere."""
    for altitude, expected in ((0.0, 101325.0), (1000.0, 89874.6), (5000.0, 54019.9)):
        text = (
            "robot = FakeRobot()\nair = Barometer()\nrobot.append(air)\nenv = Environment('empty', fastmode=True)\n"
            f"env.set_gravity({_G})\nenv.properties(longitude=1.4, latitude=43.6, altitude={altitude})\n"
        )
        with scene(text) as sim:
            sim.step(2)
            measured = float(sim.context.component("robot.air").local_data["pressure"])
        yield Figure(f"barometer at {altitude:g} m", "pressure, Pa", expected, measured, 5.0, "ISO 2533:1975, table 5")
