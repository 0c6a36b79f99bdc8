"""A satellite receiver among buildings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property
from morse.mathutils.portable import matmul, solve
from morse.plugins.senses.scanning import dot

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body, RayBundle

    Floats = NDArray[np.float64]

#: wavelength of L1, m: c / 1575.42 MHz (IS-GPS-200)
L1 = 299_792_458.0 / 1575.42e6
#: satellites: number on each ring of an elevation, degrees
_RINGS = ((5, 15.0), (4, 40.0), (3, 70.0))
#: time of a turn of the rings, s: half a sidereal day
_TURN = 43_082.0
#: horizontal rays that look for walls; walls at most; distance of walls that reflect, m
_AROUND, _WALLS, _NEAR = 72, 8, 60.0
#: length of a chip of the C/A code, m: reflections that are later by more do no harm
_CHIP = 293.0
#: unknowns of a fix: position and clock
_UNKNOWNS = 4


class GNSSReceiver(Sensor):
    """Measures the position by satellites that buildings hide and reflect.

    Twelve satellites stand on rings of 15, 40 and 70 degrees of elevation, which turn once in half a sidereal day: not
    a real constellation, but one with a typical geometry. A wall with the normal n at the distance d, in whose mirror a
    satellite is seen in the direction s, adds a signal whose way is longer by Δ = 2 d n·s. If the satellite itself is
    hidden, its range is too long by Δ; otherwise the range has the error Δ a cos φ / (1 + a cos φ) with the amplitude a
    = ``reflection`` and the phase φ = 2π Δ / λ (R. van Nee, "Spread-spectrum code and carrier synchronization errors
    caused by multipath", 1992). A hidden satellite without a reflection is not received. The position is the
    least-squares solution of the ranges; with ``errors`` they have white noise of ``range_noise``.
    """

    _name = "GNSS receiver"
    _short_desc = "Position by satellites, with multipath among buildings"
    _source = "van Nee 1992; IS-GPS-200"
    _builder = BuilderDefaults(frequency=5.0, visual=Visual("cylinder", (0.05, 0.05, 0.02), (0.9, 0.9, 0.9)))

    add_data("x", math.nan, "float", "X in the world; NaN without a fix", unit="m", frame="world", allow=("nan",))
    add_data("y", math.nan, "float", "Y in the world; NaN without a fix", unit="m", frame="world", allow=("nan",))
    add_data("z", math.nan, "float", "Z in the world; NaN without a fix", unit="m", frame="world", allow=("nan",))
    add_data("satellites", 0, "integer", "Number of received satellites", low=0, high=12)
    add_data("direct", 0, "integer", "Number of satellites in sight", low=0, high=12)
    add_data("hdop", math.inf, "float", "Horizontal dilution of precision; infinite without a fix", low=0.0, high=1e9,
             allow=("inf",))  # fmt: skip

    add_property("reflection", 0.5, "reflection", "float", "Amplitude of a reflection", low=0.0, high=0.9)
    add_property("range_noise", 1.0, "range_noise", "float", "Deviation of a range, with errors", unit="m", low=0.0,
                 high=1e3)  # fmt: skip
    add_property("errors", False, "errors", "bool", "With noise of the ranges")

    add_kind("pose", when=lambda receiver: True, position=("x", "y", "z"))

    reflection: float
    range_noise: float
    errors: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        angles = [2.0 * math.pi * index / _AROUND for index in range(_AROUND)]
        self._around = self.add_rays([(math.cos(a), math.sin(a), 0.0) for a in angles], _NEAR, upright=True)
        self._mirrored: RayBundle | None = None
        self._sky = self.context.world.rays.bundle(obj, self.satellites(), 1e4, upright=True)

    def satellites(self) -> Floats:
        """Return the directions (12, 3) of the satellites in the axes of the world."""
        turn = 2.0 * math.pi * (self.clock.time % _TURN) / _TURN
        rows = []
        for ring, (count, elevation) in enumerate(_RINGS):
            up = math.radians(elevation)
            for index in range(count):
                azimuth = turn + 2.0 * math.pi * (index + 0.37 * ring) / count
                rows.append((math.cos(up) * math.cos(azimuth), math.cos(up) * math.sin(azimuth), math.sin(up)))
        return np.array(rows)

    def measure(self) -> None:
        """Measure the position."""
        ways = self.satellites()
        self._sky.turn_to(ways)
        self._sky.refresh()
        direct = self._sky.hit < 0
        extra = self._reflections(ways)
        errors, received = np.zeros(len(ways)), direct.copy()
        for index, delays in enumerate(extra):
            if not delays:
                continue
            if direct[index]:
                shares = [self.reflection * math.cos(2.0 * math.pi * delay / L1) for delay in delays]
                errors[index] = sum(d * s / (1.0 + s) for d, s in zip(delays, shares, strict=True) if d < _CHIP)
            else:
                errors[index], received[index] = min(delays), True
        if self.errors:
            errors += self.tick_random("ranges").standard_normal(len(ways)) * self.range_noise
        data = self.local_data
        data["satellites"], data["direct"] = int(received.sum()), int(direct.sum())
        fix = self._fix(ways[received], errors[received])
        if fix is None:
            data["x"] = data["y"] = data["z"] = math.nan
            data["hdop"] = math.inf
            return
        shift, data["hdop"] = fix
        for axis, name in enumerate("xyz"):
            data[name] = float(self.bge_object.world_pose()[0][axis]) + shift[axis]

    def _reflections(self, ways: Floats) -> list[list[float]]:
        """Return for each satellite the ways, m, by which its reflections are longer."""
        around = self._around
        around.refresh()
        found: list[list[float]] = [[] for _ in ways]
        walls: dict[tuple[int, ...], tuple[Floats, float]] = {}
        for ray in np.flatnonzero(around.hit >= 0).tolist():
            normal = around.normals[ray]
            distance = float(-dot(normal[None], around.points[ray])[0])
            key = (int(around.hit[ray]), *np.round(np.append(normal, distance) * 100.0).astype(int).tolist())
            if len(walls) < _WALLS:
                walls.setdefault(key, (normal, distance))
        candidates = []
        for (solid, *_), (normal, distance) in walls.items():
            along = dot(ways, normal)
            for index in np.flatnonzero(along > 0.01).tolist():
                mirror = ways[index] - 2.0 * along[index] * normal
                candidates.append((index, solid, 2.0 * distance * float(along[index]), mirror))
        if not candidates:
            return found
        mirrors = np.array([mirror for *_, mirror in candidates])
        if self._mirrored is None:
            self._mirrored = self.context.world.rays.bundle(self.bge_object, mirrors, 1e4, upright=True)
        else:
            self._mirrored.turn_to(mirrors)
        self._mirrored.refresh()
        for ray, (index, solid, delay, _) in enumerate(candidates):
            if int(self._mirrored.hit[ray]) == solid:
                found[index].append(delay)
        return found

    def _fix(self, ways: Floats, errors: Floats) -> tuple[list[float], float] | None:
        """Return the error (3,) of the position, m, and the horizontal dilution; None if there is no solution."""
        if len(ways) < _UNKNOWNS:
            return None
        design = np.column_stack([-ways, np.ones(len(ways))])
        normal = matmul(design.T, design)
        shift = solve(normal, matmul(design.T, errors))
        columns = [solve(normal, unit) for unit in np.eye(_UNKNOWNS)[:2]]
        if shift is None or columns[0] is None or columns[1] is None:
            return None
        return [float(value) for value in shift[:3]], math.sqrt(max(float(columns[0][0] + columns[1][1]), 0.0))

    def noisy_fields(self) -> tuple[str, ...]:
        """Return the position."""
        return ("x", "y", "z")
