"""Projection and exposure of a camera."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


#: width of the sensor for a focal length, mm
SENSOR_WIDTH = 32.0
#: maximum number of pixels along one side, and of an image
MOST_PIXELS_ASIDE, MOST_PIXELS = 8192, 1 << 24
_MOST_FOCAL = 1e7


@dataclass(frozen=True, slots=True)
class Lens:
    """A pinhole lens and the sensor behind it.

    Attributes:
        width, height: pixels.
        fx, fy: focal lengths, pixels.
        cx, cy: principal point, pixels from the upper left corner; the centre of the first pixel is at 0.5.
        near, far: clipping distances along the axis, m.

    Raises:
        ValueError: the parameters are not valid.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    near: float = 0.1
    far: float = 100.0

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            size = getattr(self, name)
            if not 1 <= size <= MOST_PIXELS_ASIDE:
                raise ValueError(f"the {name} of a picture is 1 to {MOST_PIXELS_ASIDE} pixels, got {size!r}")
        if self.width * self.height > MOST_PIXELS:
            raise ValueError(f"a picture has at most {MOST_PIXELS} pixels, got {self.width} x {self.height}")
        for name in ("fx", "fy"):
            if not 0.0 < getattr(self, name) <= _MOST_FOCAL:
                raise ValueError(
                    f"{name} is a focal length in pixels, greater than 0 and at most {_MOST_FOCAL:g}, got "
                    f"{getattr(self, name)!r}"
                )
        if not (math.isfinite(self.cx) and math.isfinite(self.cy)):
            raise ValueError(f"cx and cy are pixels, got {self.cx!r} and {self.cy!r}")
        if not 1e-6 <= self.near < self.far <= 1e6:
            raise ValueError(
                f"near and far are metres with 1e-6 <= near < far <= 1e6, got near={self.near!r}, far={self.far!r}"
            )

    @classmethod
    def of_focal_length(
        cls, width: int, height: int, millimetres: float, near: float = 0.1, far: float = 100.0
    ) -> Lens:
        """The lens of a focal length, for a sensor 32 mm wide."""
        if not 0.0 < millimetres < math.inf:
            raise ValueError(f"a focal length is greater than 0 mm, got {millimetres!r}")
        f = width * millimetres / SENSOR_WIDTH
        return cls(width, height, f, f, width / 2, height / 2, near, far)

    @classmethod
    def of_angle(cls, width: int, height: int, angle: float, near: float = 0.1, far: float = 100.0) -> Lens:
        """Return the lens with a horizontal field of view, rad."""
        if not 0.0 < angle < math.pi:
            raise ValueError(
                f"the field of view of a lens without distortion is between 0 and 180 degrees, got "
                f"{math.degrees(angle):g}: use the fisheye lens, lens_model='equidistant', for wider fields of view"
            )
        f = width / 2 / math.tan(angle / 2)
        return cls(width, height, f, f, width / 2, height / 2, near, far)

    @property
    def matrix(self) -> list[list[float]]:
        """The intrinsic matrix, 3x3, pixels, with the centre of the first pixel at 0, as in OpenCV and ROS."""
        return [[self.fx, 0.0, self.cx - 0.5], [0.0, self.fy, self.cy - 0.5], [0.0, 0.0, 1.0]]

    def rays(self) -> NDArray[np.float32]:
        """(H, W, 3) float32: the point that each pixel shows at a depth of 1 m; X right, Y down, Z forward."""
        directions = np.ones((self.height, self.width, 3), np.float32)
        directions[..., 0] = (np.arange(self.width) + 0.5 - self.cx) / self.fx
        directions[..., 1] = ((np.arange(self.height) + 0.5 - self.cy) / self.fy)[:, None]
        return directions

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Project points (..., 3), X right, Y down, Z forward, to pixels (..., 2); NaN for points behind the camera."""
        with np.errstate(all="ignore"):
            ahead = np.where(points[..., 2:] > 1e-9, points[..., 2:], np.nan)
            flat = self.bend(points[..., :2] / ahead)
        return flat * (self.fx, self.fy) + (self.cx, self.cy)

    def bend(self, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        """Apply the distortion to points (..., 2) at a depth of 1."""
        return flat


# Motion blur and rolling shutter: images that are exposed over a time, not at an instant.


@dataclass(frozen=True)
class Motion:
    """When the rows of an image are exposed; the exposure of the last row ends at the tick of the image.

    Attributes:
        exposure: time for which each row is exposed, s.
        readout: time from the read-out of the first row to that of the last row, s.
        steps: number of instants of an exposure that are rendered, and number of bands of rows that are rendered apart.
    """

    exposure: float = 0.0
    readout: float = 0.0
    steps: int = 16

    def bands(self, height: int) -> list[Band]:
        """Return the bands of an image with that many rows."""
        count = min(self.steps, height) if self.readout else 1
        instants = self.steps if self.exposure else 1
        cuts = [height * number // count for number in range(count + 1)]
        return [
            Band(
                first,
                last,
                [
                    -self.readout * (1.0 - (first + last) / (2 * height)) - self.exposure * (n + 0.5) / instants
                    for n in range(instants)
                ],
            )
            for first, last in itertools.pairwise(cuts)
        ]


class Band(NamedTuple):
    """Rows that are exposed at the same time.

    Attributes:
        first, last: the first row, and one past the last row.
        times: the instants to render, s, relative to the tick of the image.
    """

    first: int
    last: int
    times: list[float]


def moved(
    positions: NDArray[np.float64],
    rotations: NDArray[np.float64],
    linear: NDArray[np.float64],
    angular: NDArray[np.float64],
    time: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return poses at another time, at constant velocities.

    Args:
        positions, rotations: (N, 3) and (N, 3, 3), frame of the world.
        linear, angular: (N, 3) m/s and (N, 3) rad/s, world axes.
        time: s, relative to that of the poses.
    """
    half = angular * (time / 2)
    square = half[:, 0] ** 2 + half[:, 1] ** 2 + half[:, 2] ** 2
    # the series of tan(a) / a: operations that are rounded the same everywhere
    x, y, z = (half * (1 + square / 3 + 2 * square**2 / 15 + 17 * square**3 / 315)[:, None]).T
    turn = np.empty((len(half), 3, 3))
    turn[:, 0] = np.stack([1 + x * x - y * y - z * z, 2 * (x * y - z), 2 * (x * z + y)], axis=1)
    turn[:, 1] = np.stack([2 * (x * y + z), 1 - x * x + y * y - z * z, 2 * (y * z - x)], axis=1)
    turn[:, 2] = np.stack([2 * (x * z - y), 2 * (y * z + x), 1 - x * x - y * y + z * z], axis=1)
    turn /= (1 + x * x + y * y + z * z)[:, None, None]
    rows = [
        sum((turn[:, i, k, None] * rotations[:, k] for k in (1, 2)), turn[:, i, 0, None] * rotations[:, 0])
        for i in range(3)
    ]
    return positions + linear * time, np.stack(rows, axis=1)
