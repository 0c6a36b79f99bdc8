"""Lens distortion: the viewing direction of each pixel.

The models are those of OpenCV and of ROS: ``plumb_bob`` of D. C. Brown (Close-Range Camera Calibration, 1971) with the
coefficients k1, k2, p1, p2, k3, and ``equidistant`` of J. Kannala and S. S. Brandt (A Generic Camera Model and
Calibration Method, 2006) with k1, k2, k3, k4, for fisheye lenses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils import portable
from morse.mathutils.portable import matmul
from morse.rendering.lens import MOST_PIXELS, Lens
from morse.rendering.textures import LIGHT, encoded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


# Images with lens distortion, sampled from undistorted images.
#
# Undistorted images are rendered in up to six directions, and sampled at the directions of the pixels: colours from
# four neighbours, depths from four neighbours on one plane, ids from the nearest neighbour. The near plane of a camera
# is that of each of its undistorted images.

#: number of pixels of undistorted images per pixel of the distorted image
_DENSITY = 1.25
#: one undistorted image is enough if no pixel is farther than 60 degrees from the axis
_ONE_IS_ENOUGH = 0.5
#: right, down, forward of the faces of a cube around the camera, in columns
_FACES = tuple(
    np.array(rows, np.float64).T
    for rows in (
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
        ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
        ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
        ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
        ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    )
)
#: unit of positions, as a share of a pixel: rounding makes differences in the last bit irrelevant
_FRACTIONS = 256
#: maximum relative deviation of 1 / depth at the corners of a square on a plane from a linear function
_FLAT = np.float32(1e-3)


class Flat(NamedTuple):
    """One of the undistorted images.

    Attributes:
        lens: its lens.
        turn: (3, 3) its axes in the frame of the camera, in columns.
        pixels: (N,) indices of the pixels that are sampled from it.
        left, top: (N,) the upper left one of the four neighbours.
        across, down: (N,) float32, interpolation weights of the other neighbours, 0 to 1.
        nearest: (N,) index of the nearest neighbour.
        stretch: (N,) float32, factor from depths along its axis to depths along that of the camera; 0 if invalid.
    """

    lens: Lens
    turn: NDArray[np.float64]
    pixels: NDArray[np.intp]
    left: NDArray[np.intp]
    top: NDArray[np.intp]
    across: NDArray[np.float32]
    down: NDArray[np.float32]
    nearest: NDArray[np.intp]
    stretch: NDArray[np.float32]


class Drawn(NamedTuple):
    """The rendered undistorted image; see `morse.rendering.Picture`."""

    rgba: NDArray[np.uint8] | None
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    normals: NDArray[np.float32] | None


class Warp:
    """The undistorted images for the image of a lens.

    Args:
        lens: a `DistortedLens`.
        directions, shows: its ``directions``.

    Attributes:
        flats: one to six, or none if no pixel is valid.
    """

    def __init__(self, lens: Lens, directions: NDArray[np.float64], shows: NDArray[np.bool_]) -> None:
        self._lens = lens
        numbers = np.flatnonzero(shows)
        rays = directions.reshape(-1, 3)[numbers]
        if not len(rays) or rays[:, 2].min() > _ONE_IS_ENOUGH:
            face = np.zeros(len(rays), np.intp)
        else:
            face = np.stack([matmul(rays, turn[:, 2]) for turn in _FACES]).argmax(axis=0)
        self.flats = [
            _flat(lens, turn, numbers[face == n], rays[face == n]) for n, turn in enumerate(_FACES) if (face == n).any()
        ]

    def gather(self, images: Sequence[Drawn]) -> Drawn:
        """The distorted image from the undistorted ones."""
        size = self._lens.height * self._lens.width
        color = bool(images) and images[0].rgba is not None
        rgba = np.zeros((size, 4), np.uint8)
        rgba[:, 3] = 255
        depth, ids = np.zeros(size, np.float32), np.full(size, -1, np.int32)
        normals = np.zeros((size, 3), np.float32) if images and images[0].normals is not None else None
        for flat, picture in zip(self.flats, images, strict=True):
            if picture.rgba is not None:
                rgba[flat.pixels, :3] = _colors(flat, picture.rgba)
            numbers = picture.ids.ravel()[flat.nearest]
            if picture.normals is not None and normals is not None:
                # these rotations permute axes, so that the products are exact
                camera_normals = matmul(picture.normals.reshape(-1, 3)[flat.nearest], flat.turn.T.astype(np.float32))
                normals[flat.pixels] = camera_normals + np.float32(0)
            depths = _depths(flat, picture, numbers) * flat.stretch
            far = depths > np.float32(self._lens.far)
            ids[flat.pixels] = np.where(far, np.int32(-1), numbers)
            if normals is not None:
                normals[flat.pixels[far]] = 0
            depth[flat.pixels] = np.where(far | (numbers < 0), np.float32(0), depths)
        shape = (self._lens.height, self._lens.width)
        return Drawn(
            rgba.reshape(*shape, 4) if color else None,
            depth.reshape(shape),
            ids.reshape(shape),
            None if normals is None else normals.reshape(*shape, 3),
        )


def _flat(lens: Lens, turn: NDArray[np.float64], pixels: NDArray[np.intp], rays: NDArray[np.float64]) -> Flat:
    own = matmul(rays, turn)
    x, y = own[:, 0] / own[:, 2], own[:, 1] / own[:, 2]
    low, high = (x.min(), y.min()), (x.max(), y.max())
    f = _DENSITY * max(lens.fx, lens.fy)
    wide, tall = high[0] - low[0], high[1] - low[1]
    # an image limited to the maximum size is less sharp
    f = min(f, np.sqrt(MOST_PIXELS / 4 / max(wide * tall, 1e-12)), 4000 / max(wide, tall, 1e-9))
    # a margin of a pixel, so that all have four neighbours
    width, height = int(np.ceil(wide * f)) + 4, int(np.ceil(tall * f)) + 4
    cx, cy = 2.0 - low[0] * f, 2.0 - low[1] * f
    u, v = (np.floor((p * f + c - 0.5) * _FRACTIONS + 0.5) for p, c in ((x, cx), (y, cy)))
    left, top = np.floor(u / _FRACTIONS), np.floor(v / _FRACTIONS)
    across, down = u / _FRACTIONS - left, v / _FRACTIONS - top
    column, row = left.astype(np.intp), top.astype(np.intp)
    nearest = (row + (down >= 0.5)) * width + column + (across >= 0.5)
    stretch = np.where(rays[:, 2] > 1e-6, rays[:, 2] / own[:, 2], 0.0)
    return Flat(
        Lens(width, height, float(f), float(f), float(cx), float(cy), lens.near, lens.far),
        turn,
        pixels,
        column,
        row,
        across.astype(np.float32),
        down.astype(np.float32),
        nearest,
        stretch.astype(np.float32),
    )


def _neighbours(flat: Flat) -> list[tuple[NDArray[np.intp], NDArray[np.float32]]]:
    """The indices of the four neighbours, and their weights."""
    first, one = flat.top * flat.lens.width + flat.left, np.float32(1)
    return [
        (first, (one - flat.across) * (one - flat.down)),
        (first + 1, flat.across * (one - flat.down)),
        (first + flat.lens.width, (one - flat.across) * flat.down),
        (first + flat.lens.width + 1, flat.across * flat.down),
    ]


def _colors(flat: Flat, rgba: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(N, 3) interpolated as linear light, not as sRGB codes."""
    pixels = rgba.reshape(-1, 4)[:, :3]
    light = np.zeros((len(flat.pixels), 3), np.float32)
    for at, share in _neighbours(flat):
        light += LIGHT[pixels[at]] * share[:, None]
    return encoded(light)


def _depths(flat: Flat, picture: Drawn, numbers: NDArray[np.int32]) -> NDArray[np.float32]:
    """(N,) 1 / depth is linear on a plane: interpolated if the neighbours are on one plane of one object."""
    depth, ids = picture.depth.ravel(), picture.ids.ravel()
    inverse, bend, same = np.zeros(len(numbers), np.float32), np.zeros(len(numbers), np.float32), numbers >= 0
    for (at, share), sign in zip(_neighbours(flat), (1, -1, -1, 1), strict=True):
        same &= ids[at] == numbers
        here = np.float32(1) / np.where(depth[at] > 0, depth[at], np.float32(1))
        inverse += share * here
        bend += np.float32(sign) * here
    same &= np.abs(bend) < _FLAT * inverse
    return np.where(same, np.float32(1) / np.where(same, inverse, np.float32(1)), depth[flat.nearest])


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
