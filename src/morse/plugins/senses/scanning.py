"""What several sensors share: rays that follow the properties, surfaces, pictures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.clients.budgets import RAY
from morse.core.sensor import Sensor
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body, RayBundle

    Floats = NDArray[np.float64]


class ScanningSensor(Sensor):
    """A sensor with one bundle of rays that its properties determine.

    Attributes:
        shaping: names of the attributes that determine `directions` and `reach`.
    """

    shaping: ClassVar[tuple[str, ...]] = ()
    _built: tuple[object, ...] = ()

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._build()

    def directions(self) -> Floats:
        """Return the directions (N, 3) of the rays in the frame of the sensor."""
        raise NotImplementedError

    def origins(self) -> Floats | None:
        """Return the begins (N, 3) of the rays in the frame of the sensor, m; None for its origin."""
        return None

    def reach(self) -> float:
        """Return the largest distance of a hit, m."""
        raise NotImplementedError

    def ray_count(self) -> float:
        """Return the number of rays that the properties demand."""
        raise NotImplementedError

    def cell_count(self) -> float:
        """Return the number of cells of an image that the properties demand."""
        return 0.0

    def sensing_cost(self) -> float:
        """Return the cost of the rays and of the cells, in pixels: what clients set has a budget."""
        return RAY * self.ray_count() + self.cell_count()

    def _shape(self) -> tuple[object, ...]:
        return tuple(getattr(self, name) for name in self.shaping)

    def _build(self) -> None:
        self._built = self._shape()
        self.remove_request(self.rays)
        self.add_rays(self.directions(), self.reach(), self.origins())

    def scan(self) -> RayBundle:
        """Return the rays with the hits of this tick."""
        if self._built != self._shape():
            self._build()
        self.rays.refresh()
        return self.rays


def grid(azimuths: Sequence[float], elevations: Sequence[float]) -> Floats:
    """Return the directions (E * A, 3) of a grid, X forward, Y left, Z up: a row for each elevation, angles in rad."""
    flat = np.array([(math.cos(a), math.sin(a)) for a in azimuths])
    rows = [np.column_stack([flat * math.cos(e), np.full(len(flat), math.sin(e))]) for e in elevations]
    return np.concatenate(rows)


def steps(width: float, count: int) -> list[float]:
    """Return the centres of ``count`` equal parts of an interval of some width around 0, ascending."""
    return [width * ((index + 0.5) / count - 0.5) for index in range(count)]


def dot(a: Floats, b: Floats) -> Floats:
    """Return the scalar products (N,) of vectors (N, 3), or of (N, 3) and (3,)."""
    return np.asarray(a[:, 0] * b[..., 0] + a[:, 1] * b[..., 1] + a[:, 2] * b[..., 2])


def own_velocity(sensor: Sensor) -> Floats:
    """Return the velocity (3,) of a sensor over the ground, in its own axes, m/s."""
    return np.array(sensor.bge_object.localLinearVelocity, dtype=np.float64)


def in_world(sensor: Sensor, vectors: Floats) -> Floats:
    """Return vectors (N, 3) in the axes of a sensor in those of the world."""
    rotation = np.array(sensor.bge_object.worldOrientation, dtype=np.float64)
    return np.asarray(matmul(vectors, rotation.T))


def by_object(rays: RayBundle, value: Callable[[Body], float]) -> Floats:
    """Return a value (N,) for each ray that depends on the object that it has hit; 0 for no hit."""
    result = np.zeros(len(rays))
    solids, first = np.unique(rays.hit, return_index=True)
    for solid, ray in zip(solids.tolist(), first.tolist(), strict=True):
        body = rays.object_of(ray) if solid >= 0 else None
        if body is not None:
            result[rays.hit == solid] = value(body)
    return result


def number_of(body: Body, name: str, default: float, low: float = 0.0, high: float = math.inf) -> float:
    """Return a property of an object as a number in a range; the default if it has none, or if it is not a number."""
    value = body.get(name)
    if isinstance(value, (int, float)) and math.isfinite(value):
        return min(max(float(value), low), high)
    return default


def palette(shares: Floats) -> NDArray[np.uint8]:
    """Return colours (..., 3) for numbers from 0 to 1: black, blue, red, yellow, white."""
    share = np.clip(np.nan_to_num(shares, nan=0.0), 0.0, 1.0)
    stops = np.linspace(0.0, 1.0, 5)
    colors = np.array([(0, 0, 0), (30, 40, 150), (210, 40, 60), (255, 200, 40), (255, 255, 255)], dtype=np.float64)
    return np.stack([np.interp(share, stops, colors[:, axis]) for axis in range(3)], axis=-1).astype(np.uint8)


def picture(pixels: NDArray[np.uint8], data: Mapping[str, object]) -> dict[str, object]:
    """Return a picture (H, W, 3) as the live view shows it, magnified until it is 256 pixels wide."""
    times = max(1, 256 // max(pixels.shape[1], 1))
    return {"image": pixels.repeat(times, axis=0).repeat(times, axis=1), "timestamp": data.get("timestamp", 0.0)}


def echoes_by_range(bins: NDArray[np.int64], power: Floats, same: NDArray[np.bool_], count: int) -> Floats:
    """Return the power (count, beams) of the echoes in each range cell of each beam.

    The rays of a beam are neighbours in elevation. If two of them hit the same surface, it fills the cells
    between theirs, so that a grazing bottom is no row of arcs.

    Args:
        bins: (E, B) the cell of each ray; ``count`` and beyond for no echo.
        power: (E, B) of each ray.
        same: (E - 1, B) whether a ray and the next one have hit the same surface.
        count: number of cells.
    """
    rows, beams = bins.shape
    near = same & (bins[:-1] < count) & (bins[1:] < count)
    step = np.where(near, bins[1:] - bins[:-1], 0)
    # a ray without such a neighbour fills as many cells as the one before it
    step = np.concatenate([step, np.zeros((1, beams), np.int64)])
    step[1:] = np.where(step[1:] == 0, step[:-1], step[1:])
    first = np.maximum(np.where(step < 0, bins + step + 1, bins), 0)
    last = np.where(step > 0, bins + step - 1, bins)
    share = np.where(bins < count, power / (last - first + 1), 0.0)
    columns = np.broadcast_to(np.arange(beams), (rows, beams))
    size = (count + 2) * beams
    begins = np.bincount((np.minimum(first, count) * beams + columns).ravel(), share.ravel(), minlength=size)
    ends = np.bincount((np.minimum(last + 1, count + 1) * beams + columns).ravel(), share.ravel(), minlength=size)
    total = np.add.accumulate((begins - ends).reshape(count + 2, beams), axis=0)[:count]
    # what rounding leaves of cells without an echo
    return np.where(total > 1e-12, total, 0.0)


def acoustic_reflectivity(body: Body) -> float:
    """Return the share of the sound that an object scatters: its property ``acoustic_reflectivity``, or 0.5."""
    return number_of(body, "acoustic_reflectivity", 0.5, high=1.0)
