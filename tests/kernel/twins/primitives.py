"""Closed formulas for the points where a ray enters and leaves a primitive.

The reference for ``c/primitives.h``: each operation is the same there, in the same order, so that
both give bit-identical results.

All functions take rays in the frame of the primitive, whose axis is Z: ``origins`` (3, N) metres,
``directions`` (3, N) unit vectors, and ``sizes`` (3, N) as collision shapes have them (half sizes;
radius and half length), one column a ray. They return two arrays (N,) of distances along the rays, negative behind the
origin; a ray that misses enters at infinity and leaves at minus infinity.

The primitives are convex: the part of a line within a primitive is an interval. The interval of an intersection of two
primitives is the intersection of the intervals, and that of a convex union is their union.
Divisions by zero must not raise or warn (`numpy.errstate`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Interval = tuple[Floats, Floats]

#: replaces a direction component of 0: finite quotients, no NaN
_PARALLEL = 1e-200


def _dot(one: Floats, other: Floats) -> Floats:
    # term by term: for a single ray, einsum adds in another order
    result: Floats = one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
    return result


def _slab(origins: Floats, directions: Floats, halves: Floats) -> Interval:
    """Between the two planes at plus and minus ``halves``, one axis or several."""
    inverses = 1.0 / np.where(np.abs(directions) < _PARALLEL, _PARALLEL, directions)
    middle, half = -origins * inverses, np.abs(halves * inverses)
    return middle - half, middle + half


def _ball(middle: Floats, rest: Floats, scale: Floats | float = 1.0) -> Interval:
    """Around ``middle``, up to the root of ``rest``, over ``scale``; empty if ``rest`` is negative."""
    root = np.sqrt(rest)  # NaN for a miss
    misses = ~(rest >= 0.0)
    enter, leave = (middle - root) / scale, (middle + root) / scale
    enter[misses], leave[misses] = np.inf, -np.inf
    return enter, leave


def _both(one: Interval, other: Interval) -> Interval:
    """The intersection of two intervals."""
    enter, leave = np.maximum(one[0], other[0]), np.minimum(one[1], other[1])
    misses = ~(enter <= leave)
    enter[misses], leave[misses] = np.inf, -np.inf
    return enter, leave


def box(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A box about the origin."""
    near, far = _slab(origins, directions, sizes)
    return _both((near[0], far[0]), _both((near[1], far[1]), (near[2], far[2])))


def sphere(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A sphere about the origin."""
    middle = -_dot(origins, directions)
    # the foot of the perpendicular, not o^2 - r^2: at large distances, that difference loses digits
    foot = origins + directions * middle
    return _ball(middle, sizes[0] ** 2 - _dot(foot, foot))


def ellipsoid(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """An ellipsoid about the origin: a sphere in scaled space."""
    directions = directions / sizes
    length = np.sqrt(_dot(directions, directions))
    enter, leave = sphere(origins / sizes, directions / length, np.ones_like(sizes))
    return enter / length, leave / length


def cylinder(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A cylinder about the Z axis with flat ends."""
    return _both(_tube(origins, directions, sizes[0]), _slab(origins[2], directions[2], sizes[1]))


def capsule(origins: Floats, directions: Floats, sizes: Floats) -> Interval:
    """A cylinder about the Z axis with a hemisphere at each end."""
    enter, leave = cylinder(origins, directions, sizes)
    for sign in (1.0, -1.0):
        shifted_origins = origins.copy()
        shifted_origins[2] -= sign * sizes[1]
        near, far = sphere(shifted_origins, directions, sizes)
        enter, leave = np.minimum(enter, near), np.maximum(leave, far)
    return enter, leave


def _tube(origins: Floats, directions: Floats, radius: Floats) -> Interval:
    """An infinite cylinder about the Z axis."""
    (x, y), (u, v) = origins[:2], directions[:2]
    scale = u * u + v * v
    # r^2 (u^2 + v^2) - (x v - y u)^2: the distance from the axis, as seen along the ray, keeps its digits
    enter, leave = _ball(-(x * u + y * v), radius**2 * scale - (x * v - y * u) ** 2, scale)
    along = np.flatnonzero(scale < 1e-20)
    if len(along):
        inside = x[along] ** 2 + y[along] ** 2 <= radius[along] ** 2
        enter[along] = np.where(inside, -np.inf, np.inf)
        leave[along] = np.where(inside, np.inf, -np.inf)
    return enter, leave


#: by the index of the kind
INTERVALS: tuple[Callable[[Floats, Floats, Floats], Interval], ...] = (box, sphere, cylinder, capsule, ellipsoid)


def first_surface(kind: int, origins: Floats, directions: Floats, sizes: Floats) -> Floats:
    """Distance (N,) to the first surface of a primitive ahead, from outside or inside; infinite if there is none."""
    enter, leave = INTERVALS[kind](origins, directions, sizes)
    distance = np.where(enter >= 0.0, enter, leave)
    distance[distance < 0.0] = np.inf
    # no -0.0: IEEE 754 does not define which zero a minimum returns
    return np.asarray(distance + 0.0)
