"""Lights and cameras."""

from __future__ import annotations

from math import pi, radians
from typing import TYPE_CHECKING

from morse.scene import Camera, Light

if TYPE_CHECKING:
    from morse.assets.blend.record import Record

_TYPES = {0: "POINT", 1: "SUN", 2: "SPOT", 3: "HEMI", 4: "AREA"}
#: since 2.80: power in watts (of a sun: irradiance in W/m^2) that looks like a lamp of energy 1. A new scene has a
#: point lamp of 1000 W. An area lamp emits only into one half space, mostly forward (1/pi of its power per steradian
#: along its axis; a point lamp 1/(4 pi)). A sun with pi W/m^2 fully lights a white wall.
_UNIT = {"POINT": 1000.0, "SPOT": 1000.0, "AREA": 250.0, "SUN": pi, "HEMI": pi}
_SHADOW, _OLD_SHADOWS = 1 << 0, (1 << 0) | (1 << 13)
_LEGACY_SENSOR = 32.0


def light(record: Record) -> Light:
    """A lamp datablock."""
    old = record.file.version < 280
    kind = _TYPES.get(record.integer("type", 0), "POINT")
    red, green, blue = (min(max(record.real(channel, 1.0), 0.0), 1e3) for channel in "rgb")
    size = record.real(record.either("spotsize", "spot_size"), 45.0 if old else 0.785)
    return Light(
        type=kind,
        color=(red, green, blue),
        energy=_energy(record) / (1.0 if old else _UNIT[kind]),
        distance=max(record.real("dist", 25.0), 1e-3) if old else 25.0,
        # the angle was stored in degrees until 2.6x; values in radians are at most pi
        spot_size=radians(size) if size > pi + 1e-3 else max(size, 0.0),
        casts_shadow=bool(record.integer("mode", 1) & (_OLD_SHADOWS if old else _SHADOW)),
    )


def camera(record: Record) -> Camera:
    """A camera datablock."""
    sensor = record.real("sensor_x", _LEGACY_SENSOR)
    start = max(record.real(record.either("clipsta", "clip_start"), 0.1), 1e-6)
    return Camera(
        focal_length=max(record.real("lens", 35.0), 1e-3) * _LEGACY_SENSOR / (sensor if sensor > 0 else _LEGACY_SENSOR),
        clip_start=start,
        clip_end=max(record.real(record.either("clipend", "clip_end"), 100.0), start * 2),
    )


def _energy(record: Record) -> float:
    """The energy that Blender shows; 5.0 adds an exposure in stops."""
    energy = max(record.real(record.either("energy_new", "energy"), 1.0), 0.0)
    exposure: float = 2.0 ** min(max(record.real("exposure", 0.0), -32.0), 32.0)
    return energy * exposure
