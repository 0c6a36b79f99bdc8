"""An automotive radar."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.air import Air, wind
from morse.helpers.components import add_data, add_kind, add_property
from morse.mathutils.portable import arccos, arctan2, cos, exp, log10, matmul, sin
from morse.plugins.senses.scanning import (
    ScanningSensor,
    by_object,
    dot,
    grid,
    number_of,
    own_velocity,
    palette,
    picture,
    steps,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body, RayBundle

    Floats = NDArray[np.float64]

#: speed of light, m/s
LIGHT = 299_792_458.0
#: signal to noise ratio from which on a cell is a detection, dB: one false alarm in exp(20) cells
THRESHOLD = 13.0
#: K of the error of a measured angle, range or velocity: resolution / (K sqrt(2 SNR)), of a monopulse antenna
#: (M. Skolnik, "Introduction to Radar Systems", 3rd edition, section 6.3)
_ACCURACY = 1.6
#: standard deviation of the velocities of drops, m/s, by turbulence and shear (R. Doviak, D. Zrnić, Doppler Radar and
#: Weather Observations, section 5.3)
_SPREAD_OF_RAIN = 1.0
#: cells on each side that a point fills, and steps of the table of the window
_CELLS, _FINE = 2, 64
#: least vertical component of the normal of ground that reflects
_LEVEL = 0.95
#: most point targets, so that no world makes a radar slow
_MOST_TARGETS = 256


def doppler_shift(velocity: float, carrier: float) -> float:
    """Return the Doppler shift, Hz, of a target that moves away at a velocity (m/s): -2 v f / c."""
    return -2.0 * velocity * carrier / LIGHT


def trihedral(edge: float, carrier: float) -> float:
    """Return the largest cross-section (m²) of a trihedral corner with edges of some length (m): 4 pi a⁴ / 3 λ²."""
    return 4.0 * math.pi * edge**4 / (3.0 * (LIGHT / carrier) ** 2)


def _window() -> Floats:
    """The power of a point in a cell at a distance of -2 to 2 cells: the spectrum of a Hann window."""
    table = []
    for index in range(2 * _CELLS * _FINE + 1):
        x = index / _FINE - _CELLS
        if abs(x) < 1e-9:
            table.append(1.0)
        elif abs(abs(x) - 1.0) < 1e-9:
            table.append(0.25)
        else:
            table.append((math.sin(math.pi * x) / (math.pi * x * (1.0 - x * x))) ** 2)
    return np.array(table)


_WINDOW = _window()


def _spread(place: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return the cells (4, N) around places in cells, and the share (4, N) of the power in each."""
    first = np.floor(place).astype(np.int64) - (_CELLS - 1)
    cells = first + np.arange(2 * _CELLS)[:, None]
    index = np.rint((cells - place + _CELLS) * _FINE).astype(np.int64)
    return cells, _WINDOW[np.clip(index, 0, len(_WINDOW) - 1)]


class Radar(ScanningSensor):
    """Measures range, angle, radial velocity and radar cross-section of what reflects, and a range-Doppler map.

    The power of an echo follows the radar equation: it is proportional to σ / r⁴. A surface of the area A at the angle
    θ to its normal has σ = A |R|² ((1 - d) sec⁴θ exp(-tan²θ / 2s²) / 2s² + 4 d cos²θ): geometrical optics of a rough
    surface with slopes of the deviation s (D. Barrick, "Rough surface scattering based on the specular point theory",
    1968), and the share d of a Lambert surface. s is half the roughness of the material, and d its roughness; |R|²
    is 1 for metal and 0.3 otherwise, or the property ``radar_reflectivity`` of the object. An object with the property
    ``radar_cross_section`` (m²), or ``radar_corner``, the edge of a trihedral corner (m), reflects like a point.

    Rain weakens echoes there and back; a receiver does not know it, so that the reported cross-section falls as well.

    Velocities are positive if the target moves away. The first velocity beyond ``max_velocity`` appears at its
    negative, as in a real radar. Without ``errors``, the noise of the map is its mean, and detections are exact.
    """

    _name = "Radar"
    _short_desc = "Measures range, angle, velocity and cross-section of reflecting objects"
    _source = "radar equation; Barrick 1968; Skolnik, Introduction to Radar Systems"
    _builder = BuilderDefaults(frequency=20.0, visual=Visual("cube", (0.02, 0.06, 0.04), (0.1, 0.1, 0.12)))
    _products = (
        BuilderDefaults(
            "ARS408",
            frequency=14.0,
            visual=Visual("cube", (0.015, 0.069, 0.045), (0.1, 0.1, 0.12)),
            properties={
                "bandwidth": 83.7e6,
                "range_bins": 140,
                "azimuth_fov": 18.0,
                "elevation_fov": 14.0,
                "ray_spacing": 0.5,
                "azimuth_resolution": 1.6,
                "max_velocity": 55.5,
                "errors": True,
            },
            doc="A Continental ARS 408-21, far scan: 250 m, 18 degrees, resolution of 1.79 m and 1.6 degrees.",
            source="data sheet of the ARS 408-21 (Continental Engineering Services): range, resolution, angles, 72 ms",
        ),
    )

    add_data(
        "detections",
        [],
        "list<objects>",
        "What was detected, the strongest first: dictionaries with range (m), azimuth and elevation (rad), velocity "
        "(m/s, positive: it moves away) and rcs (m²)",
        frame="own",
    )
    add_data(
        "map",
        np.zeros((0, 0), np.float32),
        "buffer",
        "Signal to noise ratio by range (rows, the nearest first) and velocity (columns, from -max_velocity on)",
        unit="dB",
        shape=(None, None),
        dtype="float32",
    )

    add_property("carrier", 77e9, "carrier", "float", "Frequency", unit="Hz", low=1e9, high=300e9)
    add_property(
        "bandwidth", 96e6, "bandwidth", "float", "Of a chirp; the size of a range cell is c / 2 B", unit="Hz", low=1e6,
        high=10e9,
    )  # fmt: skip
    add_property("range_bins", 64, "range_bins", "integer", "Number of range cells", low=8, high=1024)
    add_property("doppler_bins", 128, "doppler_bins", "integer", "Number of velocity cells", low=8, high=512)
    add_property(
        "max_velocity", 50.0, "max_velocity", "float", "Largest velocity that is not ambiguous", unit="m/s", low=0.1,
        high=1e3,
    )  # fmt: skip
    add_property("azimuth_fov", 90.0, "azimuth_fov", "float", "Full angle", unit="deg", low=1.0, high=180.0)
    add_property("elevation_fov", 20.0, "elevation_fov", "float", "Full angle", unit="deg", low=1.0, high=90.0)
    add_property("ray_spacing", 1.0, "ray_spacing", "float", "Angle between rays", unit="deg", low=0.2, high=10.0)
    add_property(
        "azimuth_resolution", 3.0, "azimuth_resolution", "float", "Angle at which targets are told apart", unit="deg",
        low=0.1, high=90.0,
    )  # fmt: skip
    add_property(
        "sensitivity", 100.0, "sensitivity", "float", "Distance at which 1 m² is just detected (13 dB)", unit="m",
        low=1.0, high=1e4,
    )  # fmt: skip
    add_property(
        "ground_reflection", 0.0, "ground_reflection", "float", "Amplitude of waves that level ground reflects: point "
        "targets appear stronger and weaker by interference; 0 for none", low=0.0, high=1.0,
    )  # fmt: skip
    add_property("most_detections", 100, "most_detections", "integer", "The strongest are reported", low=1, high=1000)
    add_property("errors", False, "errors", "bool", "Noise of the receiver, and errors of the detections")

    add_kind("radar_returns", records="detections")
    add_kind("image", topic="map", pixels="map", encoding="32FC1", unit="dB")

    shaping = ("azimuth_fov", "elevation_fov", "ray_spacing", "range_bins", "bandwidth")
    carrier: float
    bandwidth: float
    range_bins: int
    doppler_bins: int
    max_velocity: float
    azimuth_fov: float
    elevation_fov: float
    ray_spacing: float
    azimuth_resolution: float
    sensitivity: float
    ground_reflection: float
    most_detections: int
    errors: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._targets: tuple[int, list[Body]] = (-1, [])
        self._sight: RayBundle | None = None
        self._below: RayBundle | None = None
        self._bounced: RayBundle | None = None

    # -- rays --------------------------------------------------------------------------------

    @property
    def range_resolution(self) -> float:
        """Size of a range cell, m: c / 2 B."""
        return LIGHT / (2.0 * self.bandwidth)

    def reach(self) -> float:
        """Return the far end of the last range cell, m."""
        return self.range_bins * self.range_resolution

    def _counts(self) -> tuple[int, int]:
        return round(self.azimuth_fov / self.ray_spacing) or 1, round(self.elevation_fov / self.ray_spacing) or 1

    def ray_count(self) -> float:
        """Return the number of rays."""
        across, up = self._counts()
        return float(across * up)

    def cell_count(self) -> float:
        """Return the number of cells of the map, as pixels: one takes as long as ten of a picture."""
        return 10.0 * self.range_bins * self.doppler_bins

    def directions(self) -> Floats:
        """Return a grid of equal angles."""
        across, up = self._counts()
        return grid(steps(math.radians(self.azimuth_fov), across), steps(math.radians(self.elevation_fov), up))

    # -- measurement -------------------------------------------------------------------------

    def measure(self) -> None:
        """Measure the map and the detections."""
        echoes = np.concatenate([self._surfaces(self.scan()), self._points()])
        echoes[:, 4] *= self._constant() / np.maximum(echoes[:, 0], 0.1) ** 4
        echoes[:, 4] *= self._transmission(echoes[:, 0], echoes[:, 1], echoes[:, 2])
        rain = self._rain()
        self.local_data["map"] = self._map(echoes, rain)
        self.local_data["detections"] = self._detections(echoes, rain)

    def _transmission(self, ranges: Floats, azimuths: Floats, elevations: Floats) -> Floats:
        """Return the share (N,) of the power that rain lets through, there and back."""
        absorb = self.context.server(Air).radio_loss
        if absorb is None:
            return np.ones(len(ranges))
        flat = cos(elevations)
        ways = np.stack([flat * cos(azimuths), flat * sin(azimuths), sin(elevations)], axis=1)
        place = np.array(self.bge_object.worldPosition)
        turn = np.array(self.bge_object.worldOrientation)
        ends = place + ranges[:, None] * matmul(ways, turn.T)
        return exp(-0.2 * math.log(10.0) * absorb(self.carrier, place, ends))

    def _rain(self) -> Floats | None:
        """Return the echo of rain in a beam for each range cell (R,), as signal to noise ratio; None without rain."""
        echo_at = self.context.server(Air).radio_echo
        if echo_at is None:
            return None
        echo = echo_at(self.carrier, self.bge_object.worldPosition)
        ranges = (np.arange(self.range_bins) + 0.5) * np.float64(self.range_resolution)
        level = np.zeros(len(ranges))
        area = ranges**2 * math.radians(self.azimuth_resolution) * math.radians(self.elevation_fov)
        share = self._transmission(ranges, level, level)
        return self._constant() * echo * area * self.range_resolution / ranges**4 * share

    def _speeds_of_rain(self) -> Floats:
        """Return the mean velocities of the rain, m/s, in the beams (B,): those of the wind, away from the radar."""
        count = max(round(self.azimuth_fov / self.azimuth_resolution), 1)
        angles = steps(math.radians(self.azimuth_fov), count)
        turn = np.array(self.bge_object.worldOrientation)
        across, along = (matmul(np.array(wind(self.context, gusts=False)), turn) - own_velocity(self))[1::-1].tolist()
        return np.asarray(along * cos(angles) + across * sin(angles))

    def _constant(self) -> float:
        """Signal to noise ratio of 1 m² at 1 m."""
        return float(10.0 ** (THRESHOLD / 10.0) * self.sensitivity**4)

    def _surfaces(self, rays: RayBundle) -> Floats:
        """Return the echoes (N, 5) of surfaces: range, azimuth, elevation, velocity, cross-section."""
        hits = np.flatnonzero(rays.hit >= 0)
        ways, ranges = rays.directions[hits], rays.distances[hits]
        cosine = np.clip(-dot(rays.normals[hits], ways), 1e-3, 1.0)
        speeds = dot(rays.velocities[hits] - own_velocity(self), ways)
        gain, rough = by_object(rays, _reflectivity)[hits], by_object(rays, _roughness)[hits]
        spread = np.maximum(0.5 * rough, 0.02)
        slope = (1.0 / cosine**2 - 1.0) / (2.0 * spread**2)
        mirror = exp(-np.minimum(slope, 700.0)) / (2.0 * spread**2 * cosine**4)
        across, up = self._counts()
        flat = np.sqrt(np.maximum(1.0 - ways[:, 2] ** 2, 0.0))
        angle = math.radians(self.azimuth_fov) / across * (math.radians(self.elevation_fov) / up)
        area = ranges**2 * angle * flat / cosine
        sigma = area * gain * ((1.0 - rough) * mirror + 4.0 * rough * cosine**2)
        return np.column_stack([*_polar(ways, ranges), speeds, sigma])

    def _points(self) -> Floats:
        """Return the echoes (M, 5) of the visible point targets."""
        targets = self._point_targets()
        if not targets:
            return np.zeros((0, 5))
        position = np.array(self.bge_object.worldPosition)
        turn = np.array(self.bge_object.worldOrientation)
        away = np.array([body.worldPosition for body in targets]) - position
        ranges = np.sqrt(dot(away, away))
        inside = np.stack([dot(away, turn[:, axis]) for axis in range(3)], axis=1) / np.maximum(ranges, 1e-9)[:, None]
        _, azimuth, elevation = _polar(inside, ranges)
        seen = (ranges > 1e-3) & (ranges < self.reach())
        seen &= np.abs(azimuth) <= math.radians(self.azimuth_fov) / 2.0
        seen &= np.abs(elevation) <= math.radians(self.elevation_fov) / 2.0
        rows = np.flatnonzero(seen)
        if not len(rows):
            return np.zeros((0, 5))
        if self._sight is None or self._sight.reach != self.reach():
            self._sight = self.context.world.rays.bundle(self.bge_object, inside[rows], self.reach())
        else:
            self._sight.turn_to(inside[rows])
        self._sight.refresh()
        speeds = np.zeros(len(targets))
        sigma = np.zeros(len(targets))
        own = own_velocity(self)
        for number, row in enumerate(rows.tolist()):
            body = targets[row]
            if self._sight.distances[number] < ranges[row] and not _belongs(self._sight.object_of(number), body):
                continue
            velocity = np.array(body.worldLinearVelocity)
            speeds[row] = float(dot(velocity[None], dot(turn, inside[row]))[0])
            speeds[row] -= float(dot(own[None], inside[row])[0])
            sigma[row] = _cross_section(body, self.carrier)
        if self.ground_reflection > 0.0:
            sigma[rows] *= self._interference(away[rows], ranges[rows])
        rows = rows[sigma[rows] > 0.0]
        return np.column_stack([ranges, azimuth, elevation, speeds, sigma])[rows]

    def _interference(self, away: Floats, ranges: Floats) -> Floats:
        """Return the factors (N,) of the power of targets by the waves that the ground below the radar reflects.

        The ground turns the phase by half of a period, so that the field is 1 - g exp(-i k Δ) there and back, with the
        amplitude g and the difference Δ of the ways. At a distance d that is large against the heights,
        Δ = 2 h_t h_r / d, and for g = 1 the power is 16 sin⁴(2π h_t h_r / λ d) (Skolnik, section 8.2).

        Args:
            away: (N, 3) from the radar to the targets, in the axes of the world, m.
            ranges: (N,) their lengths.
        """
        rays = self.context.world.rays
        if self._below is None:
            self._below = rays.bundle(self.bge_object, [(0.0, 0.0, -1.0)], 1e3, upright=True)
        self._below.refresh()
        normal, height = self._below.normals[0], float(self._below.distances[0])
        factors = np.ones(len(ranges))
        if self._below.hit[0] < 0 or normal[2] < _LEVEL:
            return factors
        # the mirror image of each target, and where the way to it meets the ground
        height *= float(normal[2])
        heights = dot(away, normal) + height
        images = away - 2.0 * heights[:, None] * normal
        longer = np.sqrt(dot(images, images))
        ways = images / np.maximum(longer, 1e-9)[:, None]
        meets = height / np.maximum(-dot(ways, normal), 1e-9)
        if self._bounced is None or self._bounced.reach != self.reach():
            self._bounced = rays.bundle(self.bge_object, ways, self.reach(), upright=True)
        else:
            self._bounced.turn_to(ways)
        self._bounced.refresh()
        open_way = (heights > 0.0) & (np.abs(self._bounced.distances - meets) < 1e-3 * meets)
        share = self.ground_reflection
        phase = 2.0 * math.pi * self.carrier / LIGHT * (longer - ranges)
        field = 1.0 + share * share - 2.0 * share * cos(phase)
        return np.where(open_way, field * field, factors)

    def _point_targets(self) -> list[Body]:
        world = self.context.world
        if self._targets[0] != world.arrangement:
            own = self.robot_parent.bge_object if self.robot_parent is not None else None
            found = [body for body in world.objects() if body is not own and _is_point(body)]
            self._targets = (world.arrangement, found[:_MOST_TARGETS])
        return [body for body in self._targets[1] if _is_point(body)]

    def _map(self, echoes: Floats, rain: Floats | None) -> NDArray[np.float32]:
        rows, columns = self.range_bins, self.doppler_bins
        width = 2.0 * self.max_velocity / columns
        ranges, range_share = _spread(echoes[:, 0] / self.range_resolution - 0.5)
        speeds, speed_share = _spread((echoes[:, 3] + self.max_velocity) / width)
        inside = (ranges >= 0) & (ranges < rows)
        # (4, 4, N): each echo fills four cells of range and four of velocity
        cells = ranges[:, None] * columns + speeds % columns
        shares = (range_share * echoes[:, 4])[:, None] * speed_share
        good = np.broadcast_to(inside[:, None], cells.shape)
        power = np.bincount(cells[good], shares[good], minlength=rows * columns)
        level: Floats | float = 1.0
        if rain is not None:
            centres = (np.arange(columns) + 0.5) * width - self.max_velocity
            away = (centres - self._speeds_of_rain()[:, None] + self.max_velocity) % (2.0 * self.max_velocity)
            spectrum = exp(-0.5 * ((away - self.max_velocity) / _SPREAD_OF_RAIN) ** 2)
            spectrum = (spectrum / np.maximum(spectrum.sum(axis=1, keepdims=True), 1e-12)).sum(axis=0)
            level = (1.0 + rain[:, None] * spectrum).ravel()
        # the amplitudes of the noise and of many drops are complex and Gaussian, their powers exponential
        noise = level * self.tick_random("map").standard_exponential(rows * columns) if self.errors else level
        return log10(power + noise).reshape(rows, columns).astype(np.float32) * np.float32(10.0)

    def _detections(self, echoes: Floats, rain: Floats | None) -> list[dict[str, float]]:
        """Return a detection for each cell of range, azimuth and velocity whose power exceeds the threshold."""
        echoes = echoes[echoes[:, 4] > 0.0]
        if not len(echoes):
            return []
        beam = math.radians(self.azimuth_resolution)
        width = 2.0 * self.max_velocity / self.doppler_bins
        sizes = np.array([self.range_resolution, beam, width])
        cells = np.floor(echoes[:, [0, 1, 3]] / sizes).astype(np.int64)
        _, cell = np.unique(cells, axis=0, return_inverse=True)
        cell = cell.reshape(-1)
        power = np.bincount(cell, echoes[:, 4])
        means = np.stack([np.bincount(cell, echoes[:, axis] * echoes[:, 4]) / power for axis in range(4)], axis=1)
        order = np.argsort(-power, kind="stable")
        random = self.tick_random("detections")
        result: list[dict[str, float]] = []
        for index in order[: self.most_detections].tolist():
            ratio, mean = float(power[index]), means[index].tolist()
            if self.errors:
                ratio *= float(random.standard_exponential()) * 0.2 + 0.8
                bound = 1.0 / (_ACCURACY * math.sqrt(2.0 * max(ratio, 1.0)))
                shifts = (random.standard_normal(4) * bound * (sizes[0], beam, beam, width)).tolist()
                mean = [value + shift for value, shift in zip(mean, shifts, strict=True)]
            noise = 1.0
            if rain is not None:
                # in the cells of velocities that its spectrum fills
                share = min(width / (math.sqrt(2.0 * math.pi) * _SPREAD_OF_RAIN), 1.0)
                noise += share * float(np.interp(mean[0] / self.range_resolution - 0.5, np.arange(len(rain)), rain))
            if ratio < noise * 10.0 ** (THRESHOLD / 10.0):
                continue
            velocity = (mean[3] + self.max_velocity) % (2.0 * self.max_velocity) - self.max_velocity
            result.append(
                {
                    "range": max(mean[0], 0.0),
                    "azimuth": mean[1],
                    "elevation": mean[2],
                    "velocity": velocity,
                    "rcs": ratio * mean[0] ** 4 / self._constant(),
                }
            )
        return result

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()

    def shown(self) -> dict[str, object]:
        """The map as a picture: velocity to the right, range upwards; 40 dB from black to white."""
        values = np.asarray(self.local_data["map"], dtype=np.float64)[::-1]
        return picture(palette(values / 40.0), self.local_data) if values.size else {}


def _polar(ways: Floats, ranges: Floats) -> tuple[Floats, Floats, Floats]:
    return ranges, arctan2(ways[:, 1], ways[:, 0]), math.pi / 2.0 - arccos(np.clip(ways[:, 2], -1.0, 1.0))


def _is_point(body: Body) -> bool:
    return "radar_cross_section" in body or "radar_corner" in body


def _cross_section(body: Body, carrier: float) -> float:
    if "radar_cross_section" in body:
        return number_of(body, "radar_cross_section", 0.0, high=1e6)
    return min(trihedral(number_of(body, "radar_corner", 0.0, high=10.0), carrier), 1e9)


def _belongs(part: Body | None, whole: Body) -> bool:
    while part is not None and part is not whole:
        part = part.parent
    return part is whole


def _material(body: Body) -> Any:
    node = body.node
    materials = [*node.materials, *(node.mesh.materials if node.mesh is not None else ())]
    return next((one for one in materials if one is not None), None)


def _reflectivity(body: Body) -> float:
    if _is_point(body):
        return 0.0
    material = _material(body)
    is_metal = material is not None and material.metallic >= 0.5
    return number_of(body, "radar_reflectivity", 1.0 if is_metal else 0.3, high=1.0)


def _roughness(body: Body) -> float:
    material = _material(body)
    return 0.6 if material is None else min(max(float(material.roughness), 0.0), 1.0)
