"""Closed formulas for where a ray enters and leaves a primitive.

All functions take rays in the frame of the primitive, whose axis is Z: ``origins`` (N, 3) metres,
``directions`` (N, 3) unit vectors, ``sizes`` (N, 3) as MuJoCo gives them (box and ellipsoid: half
sizes; sphere: radius; cylinder and capsule: radius, half length). They return two arrays (N,) of
distances along the rays, negative behind the origin; a ray that misses enters at infinity.

The primitives are convex: the part of a line within one is an interval, that within an
intersection of two is the intersection of the intervals, and so is a union that is convex.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.scene import ShapeKind

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Interval = tuple[Floats, Floats]

#: stands for a direction without any component along an axis: finite quotients, no NaN
_PARALLEL = 1e-200


def _slab(origins: Floats, directions: Floats, halves: Floats) -> Interval:
    """Between the two planes at plus and minus ``halves``; any shape."""
    steps = np.where(np.abs(directions) < _PARALLEL, _PARALLEL, directions)
    near, far = (-halves - origins) / steps, (halves - origins) / steps
    return np.minimum(near, far), np.maximum(near, far)


def _quadratic(a: Floats, b: Floats, c: Floats) -> Interval:
    """Where ``a t^2 + 2 b t + c <= 0``, with ``a >= 0``; everywhere or nowhere if ``a`` vanishes."""
    parallel = a < 1e-20
    a = np.where(parallel, 1.0, a)
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    misses = np.where(parallel, c > 0.0, b * b < a * c)
    enter = np.where(parallel, -np.inf, (-b - root) / a)
    leave = np.where(parallel, np.inf, (-b + root) / a)
    return np.where(misses, np.inf, enter), np.where(misses, -np.inf, leave)


def _both(one: Interval, other: Interval) -> Interval:
    """The intersection of two intervals."""
    enter, leave = np.maximum(one[0], other[0]), np.minimum(one[1], other[1])
    return np.where(enter <= leave, enter, np.inf), leave


def _dot(one: Floats, other: Floats) -> Floats:
    result: Floats = np.einsum("ij,ij->i", one, other)
    return result


def box(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A box about the origin."""
    near, far = _slab(origins, directions, sizes)
    enter, leave = near.max(axis=1), far.min(axis=1)
    return np.where(enter <= leave, enter, np.inf), leave


def sphere(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A sphere about the origin."""
    middle = -_dot(origins, directions)
    # the foot of the perpendicular, not o^2 - r^2: far away that difference loses its digits
    foot = origins + directions * middle[:, None]
    rest = sizes[:, 0] ** 2 - _dot(foot, foot)
    half = np.sqrt(np.maximum(rest, 0.0))
    return np.where(rest >= 0.0, middle - half, np.inf), middle + half


def ellipsoid(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """An ellipsoid about the origin: a sphere once space is squeezed."""
    directions = directions / sizes
    length = np.sqrt(_dot(directions, directions))
    enter, leave = sphere(origins / sizes, directions / length[:, None], np.ones_like(sizes))
    return enter / length, leave / length


def cylinder(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A cylinder about the Z axis with flat ends."""
    return _both(_side(origins, directions, sizes[:, 0]), _slab(origins[:, 2], directions[:, 2], sizes[:, 1]))


def capsule(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A cylinder about the Z axis with a half sphere at each end."""
    enter, leave = cylinder(origins, directions, sizes)
    enter, leave = enter.copy(), np.where(enter == np.inf, -np.inf, leave)
    for sign in (1.0, -1.0):
        shifted = origins.copy()
        shifted[:, 2] -= sign * sizes[:, 1]
        near, far = sphere(shifted, directions, sizes)
        np.minimum(enter, near, out=enter)
        np.maximum(leave, far, out=leave, where=near < np.inf)
    return enter, leave


def _side(origins: Floats, directions: Floats, radius: Floats) -> Interval:
    o, d = origins[:, :2], directions[:, :2]
    a = _dot(d, d)
    scale = np.where(a < 1e-20, 1.0, a)
    middle = -_dot(o, d) / scale
    foot = o + d * middle[:, None]
    enter, leave = _quadratic(a, np.zeros_like(a), _dot(foot, foot) - radius**2)
    return enter + middle, leave + middle


INTERVALS: dict[ShapeKind, Callable[[Floats, Floats, Floats], Interval]] = {
    ShapeKind.BOX: box,
    ShapeKind.SPHERE: sphere,
    ShapeKind.CYLINDER: cylinder,
    ShapeKind.CAPSULE: capsule,
    ShapeKind.ELLIPSOID: ellipsoid,
}


def first_surface(kind: ShapeKind, origins: Floats, directions: Floats, sizes: Floats) -> Floats:
    """Distance (N,) to the first surface ahead, from outside or inside; infinite without one."""
    enter, leave = INTERVALS[kind](origins, directions, sizes)
    distance = np.where(enter >= 0.0, enter, leave)
    return np.where((enter < np.inf) & (distance >= 0.0), distance, np.inf)


def normal(kind: ShapeKind, point: Floats, size: Floats) -> Floats:
    """Outward unit normal (3,) of a primitive at a point (3,) of its surface."""
    if kind is ShapeKind.BOX:
        axis = int(np.argmax(np.abs(point) / size))
        result = np.zeros(3)
        result[axis] = np.copysign(1.0, point[axis])
        return result
    if kind is ShapeKind.ELLIPSOID:
        result = point / size**2
    elif kind is ShapeKind.CYLINDER:
        on_end = abs(point[2]) / size[1] > np.hypot(point[0], point[1]) / size[0]
        result = np.array([0.0, 0.0, point[2]]) if on_end else np.array([point[0], point[1], 0.0])
    else:
        half = size[1] if kind is ShapeKind.CAPSULE else 0.0
        result = point - [0.0, 0.0, np.clip(point[2], -half, half)]
    result = result / np.linalg.norm(result)
    return np.asarray(result, dtype=np.float64)
