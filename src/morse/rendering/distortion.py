"""Lens distortion: the viewing direction of each pixel.

The models are those of OpenCV and of ROS: ``plumb_bob`` of D. C. Brown (Close-Range Camera Calibration, 1971) with the
coefficients k1, k2, p1, p2, k3, and ``equidistant`` of J. Kannala and S. S. Brandt (A Generic Camera Model and
Calibration Method, 2006) with k1, k2, k3, k4, for fisheye lenses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable
from morse.rendering.lens import Lens
from morse.rendering.warp import Warp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

MODELS = ("plumb_bob", "equidistant")
_COUNTS = {"plumb_bob": 5, "equidistant": 4}
_STEPS, _PRECISE = 30, 1e-9
#: angle beyond which an undistorted image has no pixels
_WIDEST_RADIUS = 20.0
_MOST_COEFFICIENT = 1e6
#: maximum number of pixels: the lens takes 300 bytes for each while it is created
_MOST_PIXELS = 1 << 22


def coefficients(text: str, model: str) -> tuple[float, ...]:
    """Parse a text such as ``'[-0.3, 0.1, 0, 0]'``; missing numbers are zeros.

    Raises:
        ValueError: it is not such a list, has too many numbers, or the model is unknown.
    """
    if model not in MODELS:
        raise ValueError(f"a lens is one of {', '.join(map(repr, MODELS))}, got {model!r:.40}")
    words = str(text).strip().strip("[]()").replace(",", " ").split()
    most = _COUNTS[model]
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = [math.nan]
    if not all(abs(number) <= _MOST_COEFFICIENT for number in numbers) or len(numbers) > most:
        names = "k1, k2, p1, p2, k3" if model == "plumb_bob" else "k1, k2, k3, k4"
        raise ValueError(f"distortion of a lens '{model}' is {names}, such as '-0.28, 0.07', got {text!r:.80}")
    return (*numbers, *[0.0] * (most - len(numbers)))


@dataclass(frozen=True)
class DistortedLens(Lens):
    """A lens with distortion.

    Attributes:
        model: ``plumb_bob`` or ``equidistant``.
        coefficients: k1, k2, p1, p2, k3, or k1, k2, k3, k4.

    Raises:
        ValueError: the parameters are not valid.
    """

    model: str = "plumb_bob"
    coefficients: tuple[float, ...] = (0.0,) * 5

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.width * self.height > _MOST_PIXELS:
            raise ValueError(
                f"an image with distortion has at most {_MOST_PIXELS} pixels, got {self.width} x {self.height}"
            )

    @classmethod
    def of_fisheye_angle(
        cls, width: int, height: int, angle: float, numbers: tuple[float, ...], near: float, far: float
    ) -> DistortedLens:
        """Return the fisheye lens with a horizontal field of view, rad, up to a full turn.

        Raises:
            ValueError: the parameters are not valid.
        """
        half = angle / 2
        bent = half * _fisheye(np.array(half * half), numbers)[0]
        if not (0.0 < half <= math.pi and bent > 0.0):
            raise ValueError(f"a fisheye lens sees between 0 and 360 degrees, got {math.degrees(angle):g}")
        f = width / 2 / float(bent)
        return cls(width, height, f, f, width / 2, height / 2, near, far, "equidistant", numbers)

    @cached_property
    def directions(self) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the viewing directions (H, W, 3) as unit vectors, and whether each pixel is valid."""
        x = np.broadcast_to((np.arange(self.width) + 0.5 - self.cx) / self.fx, (self.height, self.width))
        y = np.broadcast_to(((np.arange(self.height) + 0.5 - self.cy) / self.fy)[:, None], x.shape)
        with np.errstate(all="ignore"):
            if self.model == "equidistant":
                return _of_fisheye(x, y, self.coefficients)
            return _of_plumb_bob(x, y, self.coefficients)

    def rays(self) -> NDArray[np.float32]:
        """(H, W, 3) float32: the point that each pixel shows at a depth of 1 m; zeros for invalid pixels."""
        directions, shows = self.directions
        ahead = shows & (directions[..., 2] > 1e-6)
        depth = np.where(ahead, directions[..., 2], 1.0)[..., None]
        return np.where(ahead[..., None], directions / depth, 0.0).astype(np.float32)

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Project points (..., 3) to pixels (..., 2); NaN for points outside the domain of the lens."""
        if self.model == "plumb_bob":
            return super().project(points)
        across = np.sqrt(points[..., 0] ** 2 + points[..., 1] ** 2)
        angle = portable.arctan2(across, points[..., 2])
        bent = angle * _fisheye(angle * angle, self.coefficients)[0]
        share = np.where(
            across > 1e-12, bent / np.maximum(across, 1e-12), 1 / np.maximum(np.abs(points[..., 2]), 1e-12)
        )
        return points[..., :2] * share[..., None] * (self.fx, self.fy) + (self.cx, self.cy)

    def bend(self, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        """Apply the distortion ``plumb_bob`` to points (..., 2) at a depth of 1."""
        k1, k2, p1, p2, k3 = self.coefficients
        u, v = flat[..., 0], flat[..., 1]
        r2 = u * u + v * v
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        x = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)
        return np.stack([x, v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v], axis=-1)

    @cached_property
    def warp(self) -> Warp:
        """The undistorted images from which this image is sampled."""
        return Warp(self, *self.directions)


def _of_plumb_bob(x: Floats, y: Floats, numbers: tuple[float, ...]) -> tuple[Floats, NDArray[np.bool_]]:
    """Invert the distortion with Newton's method, starting at the undistorted position of the pixel."""
    k1, k2, p1, p2, k3 = numbers
    u, v = x.copy(), y.copy()
    for _ in range(_STEPS):
        r2 = u * u + v * v
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))
        du = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u) - x
        dv = v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v - y
        a = radial + u * u * slope + 2 * p1 * v + 6 * p2 * u
        b = u * v * slope + 2 * p1 * u + 2 * p2 * v
        d = radial + v * v * slope + 6 * p1 * v + 2 * p2 * u
        determinant = a * d - b * b
        if not (abs(du) + abs(dv) > _PRECISE / 100).any():
            break
        u, v = u - (d * du - b * dv) / determinant, v - (a * dv - b * du) / determinant
    # beyond the radius at which the model is not invertible, pixels are not valid
    radii = np.arange(1, 20001) * (_WIDEST_RADIUS / 20000)
    squares = radii * radii
    rising = 1 + squares * (3 * k1 + squares * (5 * k2 + squares * 7 * k3)) > 0
    limit = _WIDEST_RADIUS if rising.all() else float(radii[int(rising.argmin())])
    shows = (abs(du) + abs(dv) < _PRECISE) & (u * u + v * v < limit * limit)
    u, v = np.where(shows, u, 0.0), np.where(shows, v, 0.0)
    directions = np.stack([u, v, np.ones_like(u)], axis=-1)
    return directions / np.sqrt(u * u + v * v + 1)[..., None], shows


def _fisheye(square: Floats, numbers: tuple[float, ...]) -> tuple[Floats, Floats]:
    """For the square of an angle: the factor of the angle, and the slope of the angle in the image."""
    k1, k2, k3, k4 = numbers
    grows = 1 + square * (k1 + square * (k2 + square * (k3 + square * k4)))
    slope = 1 + square * (3 * k1 + square * (5 * k2 + square * (7 * k3 + square * 9 * k4)))
    return grows, slope


def _of_fisheye(x: Floats, y: Floats, numbers: tuple[float, ...]) -> tuple[Floats, NDArray[np.bool_]]:
    bent = np.sqrt(x * x + y * y)
    angle = bent.copy()
    for _ in range(_STEPS):
        grows, slope = _fisheye(angle * angle, numbers)
        residual = angle * grows - bent
        if not (abs(residual) > _PRECISE / 100).any():
            break
        angle = angle - residual / slope
    angles = np.arange(1, 3142) / 1000
    rising = _fisheye(angles * angles, numbers)[1] > 0
    limit = math.pi if rising.all() else float(angles[int(rising.argmin())])
    shows = (abs(residual) < _PRECISE) & (angle >= 0) & (angle <= limit)
    angle = np.where(shows, angle, 0.0)
    sine, cosine = _sine_and_cosine(angle)
    share = np.where(bent > 0, sine / np.where(bent > 0, bent, 1.0), 1.0)
    return np.stack([x * share, y * share, cosine], axis=-1), shows


def _sine_and_cosine(angle: Floats) -> tuple[Floats, Floats]:
    """Sine and cosine from 0 to pi, by their series: those of the C library differ in the last bit between machines."""
    square = angle * angle
    sine, cosine = np.ones_like(angle), np.ones_like(angle)
    for n in range(13, 0, -1):
        sine = 1 - sine * square / ((2 * n) * (2 * n + 1))
        cosine = 1 - cosine * square / ((2 * n - 1) * (2 * n))
    return angle * sine, cosine


def lens_of(
    width: int,
    height: int,
    millimetres: float,
    degrees: float | None,
    near: float,
    far: float,
    model: str = "plumb_bob",
    distortion: str = "",
) -> Lens:
    """The lens of a camera with such properties.

    Args:
        millimetres: focal length, for a sensor 32 mm wide.
        degrees: horizontal angle of view, of ``plumb_bob`` without its distortion; replaces the focal length.
        distortion: coefficients as text, see `coefficients`.

    Raises:
        ValueError: the parameters are not valid.
    """
    numbers = coefficients(distortion, model)
    if model == "equidistant" and degrees is not None:
        return DistortedLens.of_fisheye_angle(width, height, math.radians(degrees), numbers, near, far)
    if degrees is not None:
        flat = Lens.of_angle(width, height, math.radians(degrees), near, far)
    else:
        flat = Lens.of_focal_length(width, height, millimetres, near, far)
    if model == "plumb_bob" and not any(numbers):
        return flat
    return DistortedLens(flat.width, flat.height, flat.fx, flat.fy, flat.cx, flat.cy, near, far, model, numbers)
