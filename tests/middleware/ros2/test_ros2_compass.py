"""Once around the compass: all that says where north is agrees, in every message, with the default settings."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from morse.helpers.geodesy import LocalPlane
from morse.sensors.magnetometer import DEFAULT_YEAR, MagneticField

PLACE = {"longitude": 7.6, "latitude": 46.9, "altitude": 540.0}
PARTS = """
motion = MotionVW('motion'); robot.append(motion)
plain = GPS('plain'); robot.append(plain)
gps = GPS('gps'); gps.level('extended'); robot.append(gps)
compass = Magnetometer('compass'); compass.rotate(z={turned}); robot.append(compass)
imu = IMU('imu'); imu.rotate(z={turned}); robot.append(imu)
attitude = Attitude('attitude'); attitude.properties(UseAngleAgainstNorth=True); robot.append(attitude)
"""


def _apart(one: float, other: float) -> float:
    return abs(math.remainder(one - other, math.tau))


@pytest.mark.parametrize(("world", "turned"), [(0.0, 0.0), (0.7, 0.0), (-2.0, 1.1)])
def test_once_around_the_compass(start: Callable[..., Any], world: float, turned: float) -> None:
    given = ", ".join(f"{name}={value}" for name, value in PLACE.items())
    scene = f"env.properties({given}, angle_against_north={world})"
    simulation, desk = start(PARTS.format(turned=turned), scene)
    plane = LocalPlane(*PLACE.values(), world)
    north, east, _ = MagneticField(LocalPlane(*PLACE.values()), DEFAULT_YEAR, None).north_east_down((0.0, 0.0, 0.0))
    declination = math.atan2(east, north)
    simulation.robot.motion.publish({"v": 2.0, "w": 1.0})
    seen = []
    for _ in range(16):
        simulation.step(24)
        _, ahead = simulation.world.objects_by_name["robot"].world_pose()
        x, y, _ = plane.enu_of((ahead[0], ahead[3], 0.0))
        heading = math.atan2(x, y)  # clockwise from north
        seen.append(math.degrees(heading) % 360.0)
        for topic in ("compass", "imu/mag"):
            field = desk.last(f"/robot/{topic}").magnetic_field
            magnetic = math.atan2(field.y, field.x)  # of a level sensor, X forward and Y left
            assert _apart(magnetic + turned + declination, heading) < 2e-3
            assert math.hypot(field.x, field.y) == pytest.approx(math.hypot(north, east) * 1e-9, rel=1e-3)
            assert field.z < 0.0  # down, on the northern half
        velocity = desk.last("/robot/gps/vel").twist.linear
        assert _apart(math.atan2(velocity.x, velocity.y), heading) < 0.03  # the mean of a tick of the circle
        assert _apart(math.radians(simulation.robot.gps.data["heading"]), heading) < 0.03
        turn = desk.last("/robot/attitude").orientation
        yaw = 2.0 * math.atan2(turn.z, turn.w)  # counter-clockwise from east
        assert _apart(math.pi / 2.0 - yaw, heading) < 1e-3
        one, other = desk.last("/robot/plain/fix"), desk.last("/robot/gps")
        assert (one.latitude, one.longitude) == pytest.approx((other.latitude, other.longitude), abs=1e-9)
        assert one.altitude == pytest.approx(other.altitude, abs=1e-6)
    assert max(seen) - min(seen) > 330.0


def test_coordinates_of_modifiers_are_no_position_on_the_earth(start: Callable[..., Any]) -> None:
    simulation, desk = start(
        "gps = GPS('gps'); gps.alter('ECEF'); robot.append(gps)", "env.properties(longitude=1, latitude=2, altitude=3)"
    )
    simulation.step(2)
    assert "/robot/gps" in desk.publishers
    assert "/robot/gps/fix" not in desk.publishers
