"""A Doppler velocity log."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property
from morse.mathutils.portable import matmul, solve
from morse.plugins.senses.scanning import ScanningSensor, dot, in_world, own_velocity
from morse.plugins.senses.water import sound_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

_NOTHING = [math.nan] * 3
_BEAMS = 4
#: smallest number of beams with an echo for a velocity
_NEEDED = 3


def _beams(log: DVL) -> Floats:
    return log.rays.directions


class DVL(ScanningSensor):
    """Measures the velocity over the ground by the Doppler shift of four beams, and the height above the ground.

    The beams point down (-Z) and ``beam_angle`` outwards, as a cross whose arms are 45° aside of the axes. The velocity
    is the least-squares solution of the velocities along the beams, in the axes of the sensor: three of four beams
    suffice. If fewer reach the ground between the smallest and the largest altitude, it locks to the water if
    ``water_track`` is set, and is otherwise not ``locked``: the velocity is NaN. The altitude is vertical: the mean of
    the heights of the points that the beams reach, whatever the tilt.

    With ``errors``, each velocity along a beam has a bias of ``scale_error`` and white noise of ``noise``.
    """

    _name = "DVL"
    _short_desc = "Doppler velocity log: velocity over the ground, altitude"
    _source = "N. Brokloff, Matrix algorithm for Doppler sonar navigation, Oceans 1994"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.08, 0.08, 0.05), (0.15, 0.15, 0.2)))
    _products = (
        BuilderDefaults(
            "DVLA50",
            frequency=10.0,
            visual=Visual("cylinder", (0.033, 0.033, 0.0125), (0.1, 0.1, 0.1)),
            properties={
                "beam_angle": 22.5,
                "min_altitude": 0.05,
                "max_altitude": 50.0,
                "scale_error": 0.0101,
                "noise": 0.001,
                "errors": True,
            },
            doc="A Water Linked DVL A50: 0.05 to 50 m, four beams at 22.5 degrees, 1.01 % and 0.1 cm/s.",
            source="data sheet of the DVL A50 (Water Linked), long-term accuracy of the standard version",
        ),
        BuilderDefaults(
            "DVL1000",
            frequency=8.0,
            visual=Visual("cylinder", (0.057, 0.057, 0.08), (0.15, 0.15, 0.2)),
            properties={
                "beam_angle": 25.0,
                "min_altitude": 0.2,
                "max_altitude": 75.0,
                "scale_error": 0.001,
                "noise": 0.001,
                "errors": True,
            },
            doc="A Nortek DVL1000: 0.2 to 75 m, four beams at 25 degrees, 0.1 % and 0.1 cm/s.",
            source="data sheet of the DVL1000 (Nortek): range, beams, long-term accuracy",
        ),
    )

    add_data(
        "velocity",
        _NOTHING,
        "vec3<float>",
        "Velocity; NaN without lock",
        unit="m/s",
        frame="own",
        shape=3,
        allow=("nan",),
    )
    add_data(
        "altitude",
        math.inf,
        "float",
        "Height above the ground; infinite without the ground",
        unit="m",
        low=0.0,
        allow=("inf",),
    )
    add_data("locked", False, "bool", "Whether a velocity is measured")
    add_data("reference", "none", "string", "What the velocity is relative to: bottom, water or none")
    add_data(
        "ranges",
        [math.inf] * _BEAMS,
        "list<float>",
        "Distance along each beam; infinite without an echo",
        unit="m",
        shape=_BEAMS,
        low=0.0,
        allow=("inf",),
    )
    add_data(
        "beam_velocities",
        [math.nan] * _BEAMS,
        "list<float>",
        "Velocity along each beam, towards its end",
        unit="m/s",
        shape=_BEAMS,
        allow=("nan",),
    )

    add_property(
        "beam_angle", 30.0, "beam_angle", "float", "Between each beam and the axis", unit="deg", low=5.0, high=60.0
    )
    add_property("min_altitude", 0.3, "min_altitude", "float", "Smallest altitude", unit="m", low=0.0, high=1e4)
    add_property("max_altitude", 100.0, "max_altitude", "float", "Largest altitude", unit="m", low=0.1, high=1e4)
    add_property("water_track", False, "water_track", "bool", "Lock to the water beyond the largest altitude")
    add_property(
        "current_x",
        0.0,
        "current_x",
        "float",
        "Velocity of the water along X of the world",
        unit="m/s",
        low=-10.0,
        high=10.0,
    )
    add_property(
        "current_y",
        0.0,
        "current_y",
        "float",
        "Velocity of the water along Y of the world",
        unit="m/s",
        low=-10.0,
        high=10.0,
    )
    add_property("temperature", 10.0, "temperature", "float", "Of the water", unit="°C", low=-2.0, high=40.0)
    add_property("salinity", 35.0, "salinity", "float", "Of the water, parts per thousand", low=0.0, high=45.0)
    add_property("scale_error", 0.002, "scale_error", "float", "Share of the velocity", low=0.0, high=0.5)
    add_property(
        "noise", 0.003, "noise", "float", "Deviation of the velocity along a beam", unit="m/s", low=0.0, high=10.0
    )
    add_property("errors", False, "errors", "bool", "With the errors of a real log")

    add_kind(
        "doppler_log",
        velocity="velocity",
        altitude="altitude",
        locked="locked",
        reference="reference",
        beams=_beams,
        ranges="ranges",
        beam_velocities="beam_velocities",
        sound_speed=lambda log: log.sound_speed(),
    )

    shaping = ("beam_angle", "max_altitude")
    beam_angle: float
    min_altitude: float
    max_altitude: float
    water_track: bool
    current_x: float
    current_y: float
    temperature: float
    salinity: float
    scale_error: float
    noise: float
    errors: bool

    def directions(self) -> Floats:
        """Return the four beams: ahead to the left, back to the left, back to the right, ahead to the right."""
        angle = math.radians(self.beam_angle)
        aside = math.sin(angle) * math.sqrt(0.5)
        return np.array([(x * aside, y * aside, -math.cos(angle)) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))])

    def reach(self) -> float:
        """Return the length of a beam whose end is at the largest altitude, if the sensor is level, m."""
        return self.max_altitude / math.cos(math.radians(self.beam_angle))

    def ray_count(self) -> float:
        """Return the number of beams."""
        return float(_BEAMS)

    def sound_speed(self) -> float:
        """Return the speed of sound at the depth of the sensor below z = 0, m/s."""
        return sound_speed(self.temperature, self.salinity, max(-self.position_3d.z, 0.0))

    def measure(self) -> None:
        """Measure velocity and altitude."""
        rays, data = self.scan(), self.local_data
        heights = -in_world(self, rays.directions)[:, 2] * rays.distances
        good = (rays.hit >= 0) & (heights >= self.min_altitude)
        along = dot(rays.directions, own_velocity(self)) - dot(rays.directions, rays.velocities)
        reference = "bottom" if np.count_nonzero(good) >= _NEEDED else "none"
        used = good
        if reference == "none" and self.water_track:
            reference, used = "water", np.ones(_BEAMS, dtype=bool)
            water = np.array([[self.current_x, self.current_y, 0.0]])
            along = dot(rays.directions, own_velocity(self)) - dot(in_world(self, rays.directions), water)
        if self.errors:
            noise = self.tick_random("velocity").standard_normal(_BEAMS) * self.noise
            along = along * (1.0 + self.scale_error) + noise
        data["ranges"] = np.where(good, rays.distances, math.inf).tolist()
        data["altitude"] = float(heights[good].mean()) if good.any() else math.inf
        data["reference"], data["locked"] = reference, reference != "none"
        data["beam_velocities"] = np.where(used, along, math.nan).tolist()
        velocity = _fitted(rays.directions[used], along[used]) if data["locked"] else None
        data["velocity"] = _NOTHING if velocity is None else velocity

    def noisy_fields(self) -> tuple[str, ...]:
        """Return the fields with noise of the script."""
        return ("velocity", "altitude") if self.local_data["locked"] else ()


def _fitted(beams: Floats, along: Floats) -> list[float] | None:
    """Return the velocity (3,) that fits best to the velocities along beams (N, 3)."""
    found = solve(matmul(beams.T, beams), matmul(beams.T, along))
    return None if found is None else [float(value) for value in found]
