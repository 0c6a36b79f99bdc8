"""Position of the sensor in the world or on the earth."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.rows.columns import POSITIONS, in_columns
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_level, add_state, on_read
from morse.helpers.geodesy import LocalPlane, has_place

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_SIMPLE = ["simple"]
_RAW = ["raw", "extended"]
_EXTENDED = ["extended"]
#: speed over ground below which the heading is undefined, m/s
_STANDSTILL = 1e-3


def _has_fix(gps: GPS) -> bool:
    """Whether the position in the world is one on the earth, too: no modifier has replaced its coordinates."""
    from morse.core.kinds.binding import fields_of

    return has_place(gps.context.scene.properties) and fields_of(gps)["x"].frame == "world"


def _on_earth(gps: GPS) -> tuple[float, float, float]:
    """Return longitude, latitude (degrees) and altitude (m) of the measured position in the world."""
    data = gps.local_data
    return LocalPlane.of(gps.context.scene.properties).geodetic_of((data["x"], data["y"], data["z"]))


def _utc(gps: GPS) -> str | None:
    """Return date and time in ISO 8601 format; None for levels without date."""
    date, clock = gps.local_data.get("date"), gps.local_data.get("time")
    if not date or not clock:
        return None
    century = "19" if date[4:6] >= "69" else "20"  # POSIX convention for two-digit years
    return f"{century}{date[4:6]}-{date[2:4]}-{date[0:2]}T{clock[0:2]}:{clock[2:4]}:{clock[4:6]}Z"


class GPS(Sensor):
    """Measures the position: in the world, or on the earth.

    The levels ``raw`` and ``extended`` need the position of the world on the earth:
    ``env.properties(longitude=..., latitude=..., altitude=...)``, degrees and metres above the WGS84 ellipsoid, and
    optionally ``angle_against_north``, rad. At 0 the X axis of the world points east. With such a position, messages
    of ROS, recordings and others have the fix on the earth at the level ``simple``, too, on the topic ``fix``.
    """

    _name = "GPS"
    _short_desc = "A GPS sensor that returns the position in the world, or longitude, latitude and altitude"
    _source = "WGS84 ellipsoid: NGA.STND.0036"
    _builder = BuilderDefaults(visual=Visual("sphere", (0.04, 0.04, 0.02), (0.5, 0.5, 0.1)))

    add_level("simple", None, doc="position in the world", default=True)
    add_level("raw", "morse.sensors.gps.RawGPS", doc="longitude, latitude, altitude and velocity")
    add_level("extended", "morse.sensors.gps.ExtendedGPS", doc="also date, time and heading")

    add_data("x", 0.0, "float", "X in the world", _SIMPLE, unit="m", frame="world")
    add_data("y", 0.0, "float", "Y in the world", _SIMPLE, unit="m", frame="world")
    add_data("z", 0.0, "float", "Z in the world", _SIMPLE, unit="m", frame="world")
    add_data("longitude", 0.0, "float", "Longitude", _RAW, unit="deg", frame="wgs84", low=-180.0, high=180.0)
    add_data("latitude", 0.0, "float", "Latitude", _RAW, unit="deg", frame="wgs84", low=-90.0, high=90.0)
    add_data("altitude", 0.0, "float", "Height above the WGS84 ellipsoid", _RAW, unit="m", frame="wgs84")
    add_data(
        "velocity",
        [0.0, 0.0, 0.0],
        "vec3<float>",
        "Velocity to the east, to the north and up",
        _RAW,
        unit="m/s",
        frame="enu",
        shape=3,
    )
    add_data("date", "", "string", "DDMMYY", _EXTENDED)
    add_data("time", "", "string", "HHMMSS", _EXTENDED)
    add_data(
        "heading",
        math.inf,
        "float",
        "Course over ground, clockwise from north; infinite at standstill",
        _EXTENDED,
        unit="deg",
        low=0.0,
        high=360.0,
        allow=("inf",),
        follows="velocity",
    )
    add_kind("pose", level="simple", position=("x", "y", "z"))
    add_kind(
        "fix",
        level="simple",
        when=_has_fix,
        topic="fix",
        longitude=lambda gps: _on_earth(gps)[0],
        latitude=lambda gps: _on_earth(gps)[1],
        altitude=lambda gps: _on_earth(gps)[2],
    )
    add_kind(
        "fix",
        level=_RAW,
        longitude="longitude",
        latitude="latitude",
        altitude="altitude",
        velocity="velocity",
        course="heading",
        utc=_utc,
    )

    @on_read
    @in_columns(POSITIONS)
    def measure(self) -> None:
        """Measure the position in the world."""
        data = self.local_data
        data["x"], data["y"], data["z"] = self.position_3d.get_pose()[0]


class RawGPS(GPS):
    """Measures the position on the earth; `GPS` at the level ``raw``."""

    add_state("_before", tuple | None, "Position at the last measurement")
    add_state("_time", float, "Time of the last measurement", unit="s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._plane = LocalPlane.of(self.context.scene.properties)
        self._time = self.clock.time
        self._before = self.position_3d.get_pose()[0]

    def measure(self) -> None:
        """Measure the position, and the velocity from the previous position."""
        here, now, data = self.position_3d.get_pose()[0], self.clock.time, self.local_data
        data["longitude"], data["latitude"], data["altitude"] = self._plane.geodetic_of(here)
        dt = now - self._time
        if dt > 0.0:
            (x, y, z), (x0, y0, z0) = here, self._before
            data["velocity"] = list(self._plane.enu_of(((x - x0) / dt, (y - y0) / dt, (z - z0) / dt)))
        self._before, self._time = here, now


class ExtendedGPS(RawGPS):
    """Measures the position on the earth, date, time and heading; `GPS` at the level ``extended``.

    Date and time are simulated time, starting at 1 January 1970, unless the scene uses absolute time
    (``env.set_start_date(...)`` or ``env.use_relative_time(False)``).
    """

    def measure(self) -> None:
        """Measure position, velocity, date and time."""
        super().measure()
        utc = time.gmtime(self.clock.time)
        self.local_data["date"] = time.strftime("%d%m%y", utc)
        self.local_data["time"] = time.strftime("%H%M%S", utc)

    def report(self) -> None:
        """Compute the heading from the velocity."""
        east, north, _ = self.local_data["velocity"]
        moving = math.hypot(east, north) > _STANDSTILL
        self.local_data["heading"] = math.degrees(math.atan2(east, north)) % 360.0 if moving else math.inf
