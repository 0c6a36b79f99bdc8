"""Laser scanners."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.clients.budgets import RAY
from morse.core.declarations import BuilderDefaults, Visual
from morse.core.exceptions import MorseRPCTypeError
from morse.core.limits import ANGLE
from morse.core.rows.columns import Columns, arrays_of, in_columns
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.core.streams.local_data import Later, LocalData
from morse.helpers.components import add_data, add_kind, add_level, add_property, computed, on_read, prop
from morse.helpers.fans import MOST_LAYERS, fan
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.limits import Limits
    from morse.core.realism import Noise
    from morse.core.robot import Robot
    from morse.core.values import Fields, Value
    from morse.core.world import Body, Sight

#: downward tilt of the fan of a rotating scanner
_TILT = math.radians(12.0)


def _is_flat(scanner: LaserScanner) -> bool:
    return scanner.layers == 1 and not scanner.turns


def _is_deep(scanner: LaserScanner) -> bool:
    return not _is_flat(scanner)


def _once_round(values: object, scan_window: float) -> NDArray[np.float64]:
    """Return the values (..., N) of all rays of a flat fan, without the last ray if it equals the first."""
    array = np.asarray(values)
    return array[..., :-1] if scan_window == 360.0 and array.shape[-1] > 1 else array


def _ranges(
    data: Mapping[str, object], laser_range: float, scan_window: float, range_min: float = 0.0
) -> NDArray[np.float64]:
    """Return the distances (..., N), m; infinite for no hit, negative infinite for one that is too near (REP 117)."""
    ranges = _once_round(data["range_list"], scan_window)
    far = np.where(ranges >= laser_range, np.inf, ranges)
    return np.where(ranges < range_min, -np.inf, far) if np.any(range_min) else far


def _remissions(data: Mapping[str, object], scan_window: float) -> NDArray[np.float64] | None:
    """Return the remissions (..., N) of all rays; None if they are not measured."""
    return _once_round(data["remission_list"], scan_window) if "remission_list" in data else None


def _nearest(scanner: LaserScanner) -> float:
    """The smallest distance, m."""
    ranges = _ranges(scanner.local_data, scanner.laser_range, scanner.scan_window)
    return float(np.min(ranges, initial=np.inf))


def _hits(scanner: LaserScanner) -> NDArray[np.bool_]:
    """Return booleans (N,): rays with a hit that is not too near."""
    ranges = np.asarray(scanner.local_data["range_list"])
    return (ranges < scanner.laser_range) & (ranges >= scanner.range_min)


def _points(scanner: LaserScanner) -> NDArray[np.float64]:
    """Return the hit points (M, 3), m."""
    return np.asarray(scanner.local_data["point_list"])[_hits(scanner)]


def _intensity(scanner: LaserScanner) -> NDArray[np.float64] | None:
    """Return the remissions (M,) of the hit points; None if they are not measured."""
    data = scanner.local_data
    return np.asarray(data["remission_list"])[_hits(scanner)] if "remission_list" in data else None


def _layer(scanner: LaserScanner) -> NDArray[np.intp]:
    """Return the layer of each hit point (M,), from top to bottom."""
    hits = _hits(scanner)
    return (np.arange(len(hits)) * scanner.layers // max(len(hits), 1))[hits]


def _seen(sight: Sight) -> NDArray[np.float64]:
    """The distances of a cast."""
    ranges: NDArray[np.float64] = sight.ranges
    return ranges


def _ranges_at(_snapshots: object, arrays: Sequence[Sequence[NDArray[np.float64]]]) -> dict[str, Sequence[object]]:
    """The distances of many casts, from which the points follow."""
    return {"range_list": arrays_of(arrays)}


_SEPARATION: Limits = {"unit": "deg", "low": -180.0, "high": 180.0}
_OFFSET: Limits = {"unit": "deg", "low": -360.0, "high": 360.0}
_SCAN: Fields = {
    "ranges": computed(_ranges, "laser_range", "scan_window", "range_min", by_rows=True),
    "intensities": computed(_remissions, "scan_window", by_rows=True),
    "angle_min": prop("scan_window", scale=-0.5),
    "angle_increment": prop("resolution"),
    "range_min": prop("range_min"),
    "range_max": prop("laser_range"),
}


class LaserScanner(Sensor):
    """Measures the distance to the first object along each ray of a fan, or of several fans above each other.

    Rays are ordered from right to left, layer by layer, from top to bottom. Rays ignore the robot of the scanner and
    objects that do not collide.
    """

    _name = "Laser scanner"
    _short_desc = "Generic laser range sensors"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.05, 0.05, 0.05), (0.1, 0.1, 0.1)))
    _products = (
        BuilderDefaults(
            "Sick",
            frequency=10.0,
            model="sick",
            part="SickMesh",
            doc="A SICK LMS: 30 m, 180 degrees, 1 degree, 10 Hz.",
        ),
        BuilderDefaults(
            "SickLDMRS",
            frequency=4.0,
            properties={"scan_window": 100.0, "resolution": 0.25, "layers": 4},
            visual=Visual("cube", (0.05, 0.0825, 0.044), (1.0, 1.0, 0.9)),
            doc="A SICK LD-MRS: 30 m, 100 degrees, 0.25 degrees, four layers, 4 Hz.",
        ),
        BuilderDefaults(
            "Hokuyo",
            frequency=10.0,
            properties={"scan_window": 270.0, "resolution": 0.25},
            visual=Visual("cylinder", (0.04, 0.04, 0.08), (0.0, 0.0, 0.0)),
            doc="A Hokuyo: 30 m, 270 degrees, 0.25 degrees, 10 Hz.",
        ),
        BuilderDefaults(
            "VLP16",
            frequency=10.0,
            properties={
                "laser_range": 100.0,
                "range_min": 0.5,
                "scan_window": 359.8,
                "resolution": 0.2,
                "layers": 16,
                "layer_separation": 2.0,
                "layer_offset": 0.0,
            },
            visual=Visual("cylinder", (0.1033, 0.1033, 0.0717), (0.1, 0.1, 0.1)),
            doc="A Velodyne VLP-16: 100 m, 16 layers from 15 degrees up to 15 degrees down, all around in steps of 0.2 "
            "degrees, 10 Hz. The whole circle is measured at once, in a frame that does not turn.",
            source="user manual of the VLP-16 (Velodyne, 63-9243)",
        ),
        BuilderDefaults(
            "Infrared",
            frequency=10.0,
            properties={"laser_range": 2.0, "scan_window": 20.0, "Visible_arc": True},
            visual=Visual("cube", (0.02, 0.02, 0.02), (0.8, 0.8, 0.8)),
            doc="An infrared proximity sensor: 2 m, 20 degrees, 1 degree, 10 Hz.",
        ),
    )

    add_level("raw", None, doc="points and distances", default=True)
    add_level("rssi", None, doc="with the remission: the share of the light that is reflected")
    add_level("range", None, doc="distances alone")

    add_data(
        "point_list",
        [],
        "list",
        "Hit point of each ray, [x, y, z]; [0, 0, 0] for no hit",
        level=["raw", "rssi"],
        unit="m",
        frame="own",
        shape=(None, 3),
        dtype="float64",
        follows="range_list",
    )
    add_data(
        "range_list",
        [],
        "list",
        "Distance along each ray; laser_range for no hit",
        unit="m",
        frame="own",
        shape=(None,),
        dtype="float64",
        low=0.0,
    )
    add_data(
        "remission_list",
        [],
        "list",
        "Specular reflection at each hit point; 0 for no hit",
        level="rssi",
        shape=(None,),
        dtype="float64",
        low=0.0,
        high=1.0,
    )

    add_property("laser_range", 30.0, "laser_range", "float", "Largest distance", unit="m", low=1e-3, high=1e7)
    add_property(
        "range_min", 0.0, "range_min", "float", "Smallest distance: messages have no points nearer than it", unit="m",
        low=0.0, high=1e7,
    )  # fmt: skip
    add_property("resolution", 1.0, "resolution", "float", "Angle between two rays", unit="deg", low=1e-3, high=360.0)
    add_property("scan_window", 180.0, "scan_window", "float", "Full angle of the fan", unit="deg", low=0.0, high=360.0)
    add_property("visible_arc", False, "Visible_arc", "bool", "Show the rays in the view")
    add_property("layers", 1, "layers", "integer", "Number of fans above each other", low=1, high=MOST_LAYERS)
    add_property("layer_separation", 0.8, "layer_separation", "float", "Angle between two layers", **_SEPARATION)
    add_property("layer_offset", 0.125, "layer_offset", "float", "Horizontal rotation of every other layer", **_OFFSET)

    add_property("on_demand", False, "on_demand", "bool", "Rays are only cast while somebody reads them")
    add_kind(
        "range",
        level="range",
        distance=_nearest,
        min=prop("range_min"),
        max=prop("laser_range"),
        fov=prop("scan_window"),
        radiation="infrared",
    )
    add_kind("scan", level=["raw", "rssi"], when=_is_flat, **_SCAN)
    add_kind("scan", level="range", when=_is_flat, topic="scan", **_SCAN)
    add_kind("cloud", level=["raw", "rssi"], when=_is_deep, points=_points, intensity=_intensity, ring=_layer)
    add_kind("cloud", level=["raw", "rssi"], when=_is_flat, topic="points", on_request=True, points=_points)

    #: whether the fan rotates about the vertical axis, so that its rays do not lie in one plane
    turns = False
    laser_range: float
    range_min: float
    resolution: float
    scan_window: float
    visible_arc: bool
    layers: int
    layer_separation: float
    layer_offset: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.local_data = LocalData(self.local_data)
        self.create_laser_arc()

    def create_laser_arc(self) -> None:
        """Create the rays from the properties.

        Raises:
            ValueError: the properties are not valid for a fan.
        """
        self._arc = self._arc_properties()
        self.remove_request(self.rays)
        self.add_rays(self._directions(), self.laser_range)

    def _arc_properties(self) -> tuple[float, ...]:
        return (
            self.laser_range,
            self.scan_window,
            self.resolution,
            self.layers,
            self.layer_separation,
            self.layer_offset,
        )

    def _directions(self) -> NDArray[np.float64]:
        _, *shape = self._arc_properties()
        return fan(*shape)

    def sensing_cost(self) -> float:
        """Return the number of rays, in pixels."""
        return RAY * (self.scan_window / self.resolution + 1.0) * self.layers

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        before = dict(self.__dict__)
        super().set_property(name, value)
        try:
            self._directions()
        except ValueError as error:
            self.__dict__.update(before)
            raise MorseRPCTypeError(f"{self.name()}: {error}") from None

    def observe(self) -> Value:
        """Return the present hits of the rays; the rays are created again if properties were changed."""
        if self._arc != self._arc_properties():
            self.create_laser_arc()
        rays = self.rays
        rays.refresh()
        return rays.sight

    @on_read
    @in_columns(Columns(("range_list",), _ranges_at, keep=_seen))
    def measure(self) -> None:
        """Measure the scan."""
        sight, data = self.observation(), self.local_data
        # copied, because the bundles of a cast share their arrays
        data["range_list"] = Later(lambda: sight.ranges.copy())
        if self.level == "rssi":
            data["remission_list"] = sight.remissions

    def report(self) -> None:
        """Compute the points from the distances; without noise they are the points of the cast."""
        if self.level == "range":
            return
        rays, data = self.rays, self.local_data
        if self.realism is None:
            sight = self.observation()
            data["point_list"] = Later(lambda: sight.points.copy())
            return
        distances = data["range_list"]
        has_hit = distances < self.laser_range
        data["point_list"] = rays.directions * np.where(has_hit, distances, 0.0)[:, None] + 0.0
        if "remission_list" in data:
            data["remission_list"] = np.where(has_hit, data["remission_list"], 0.0)

    def may_wait(self) -> bool:
        """Return False with remissions, because they may change until they are read."""
        return self.level != "rssi"

    def noisy_fields(self) -> tuple[str, ...]:
        """Return the fields with noise: distances, from which the points are computed."""
        return ("range_list",)

    def add_noise(self, field: str, noise: Noise, before: object) -> None:
        """Add errors to distances or remissions; a lost echo is reported as no hit."""
        rays, data = self.rays, self.local_data
        has_hit = rays.hit >= 0
        values = data[field]
        if field != "range_list":
            values[has_hit] = noise.possible(noise.errors(values[has_hit], common=True))
            return
        data[field] = echoes(values, has_hit, noise, self.laser_range)


def echoes(
    ranges: NDArray[np.float64], has_hit: NDArray[np.bool_], noise: Noise, laser_range: float
) -> NDArray[np.float64]:
    """Return distances (N,) with errors, m; those without a hit, or whose echo is lost, are the largest distance."""
    distances = noise.errors(ranges, common=True)
    has_hit = has_hit & ~noise.lost(len(ranges)) & (distances < laser_range)
    return np.where(has_hit, np.maximum(distances, 0.0), laser_range)


class LaserScannerRotationZ(LaserScanner):
    """A laser scanner with an upright fan that rotates about the vertical axis by one step per measurement.

    The fan is tilted 12 degrees down, like that of a Velodyne HDL-64E, which covers angles from 2 degrees up to 25
    degrees down.
    """

    _name = "Velodyne"
    _short_desc = "Rotating laser scanner with an upright fan of rays"
    _builder = BuilderDefaults(
        "VelodyneRayCast",
        frequency=10.0,
        properties={"laser_range": 50.0, "scan_window": 31.5, "resolution": 0.5},
        model="velodyne",
        part="VelodyneMesh",
        doc="A rotating upright fan of rays: 50 m, 31.5 degrees, 0.5 degrees; rotated by 0.01745 rad per measurement.",
    )

    add_property("_rotation", 0.01745, "rotation", "float", "Step about the Z axis after each measurement", **ANGLE)

    turns = True
    _rotation: float

    def _directions(self) -> NDArray[np.float64]:
        flat = super()._directions()
        # a quarter turn about X, then the tilt about Y
        upright = np.stack([flat[:, 0], -flat[:, 2], flat[:, 1]], axis=1)
        c, s = math.cos(_TILT), math.sin(_TILT)
        return np.asarray(matmul(upright, np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])))

    def measure(self) -> None:
        """Measure the scan, and rotate."""
        super().measure()
        self.bge_object.applyRotation((0.0, 0.0, self._rotation), True)
