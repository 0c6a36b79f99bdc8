"""Intersections of rays and shapes, one surface at a time: the expected values of tests.

Every candidate point on the full surfaces (planes, tubes, spheres) is tested for lying within
its part of the shape.
"""

import math

import numpy as np

from morse.scene import ShapeKind

_SLACK = 1e-9


def roots(a, b, c):
    """Real solutions of a t^2 + b t + c = 0."""
    if abs(a) < 1e-15:
        return []
    disc = b * b - 4 * a * c
    if disc < 0:
        return []
    return [(-b - math.sqrt(disc)) / (2 * a), (-b + math.sqrt(disc)) / (2 * a)]


def _ball(o, d, centre, radii):
    o, d = (o - centre) / radii, d / radii
    return roots(d @ d, 2 * o @ d, o @ o - 1)


def _tube(o, d, radius):
    return roots(d[0] ** 2 + d[1] ** 2, 2 * (o[0] * d[0] + o[1] * d[1]), o[0] ** 2 + o[1] ** 2 - radius**2)


def _plane(o, d, axis, height):
    return [(height - o[axis]) / d[axis]] if d[axis] else []


def candidates(kind, size, o, d):
    """Distances at which a ray in the frame of a shape intersects its surface."""
    found = []
    if kind is ShapeKind.BOX:
        for axis in range(3):
            others = [i for i in range(3) if i != axis]
            for sign in (-1, 1):
                sides = _plane(o, d, axis, sign * size[axis])
                found += [t for t in sides if all(abs((o + t * d)[i]) <= size[i] + _SLACK for i in others)]
    elif kind is ShapeKind.SPHERE:
        found = _ball(o, d, np.zeros(3), np.full(3, size[0]))
    elif kind is ShapeKind.ELLIPSOID:
        found = _ball(o, d, np.zeros(3), np.array(size))
    else:
        radius, half = size
        found = [t for t in _tube(o, d, radius) if abs((o + t * d)[2]) <= half + _SLACK]
        for sign in (-1, 1):
            if kind is ShapeKind.CYLINDER:
                ends = _plane(o, d, 2, sign * half)
                found += [t for t in ends if math.hypot(*(o + t * d)[:2]) <= radius + _SLACK]
            else:
                ends = _ball(o, d, np.array([0, 0, sign * half]), np.full(3, radius))
                found += [t for t in ends if sign * (o + t * d)[2] >= half - _SLACK]
    return [t for t in found if t >= 0]


def first_hit(shapes, origin, direction):
    """Distance to the nearest of ``(CollisionShape, position, rotation)``, infinite for none."""
    best = math.inf
    for shape, position, rotation in shapes:
        o, d = rotation.T @ (origin - position), rotation.T @ direction
        best = min([best, *candidates(shape.kind, shape.size, o, d)])
    return best


def grazes(shapes, origin, direction, by=1e-4):
    """Whether a slightly different ray has a very different result: then both results are accepted."""
    side = np.cross(direction, [0.3, -0.5, 0.8])
    side /= np.linalg.norm(side)
    up = np.cross(direction, side)
    answers = [first_hit(shapes, origin, direction)]
    answers += [first_hit(shapes, origin + step * direction, direction) + step for step in (by, -by)]
    answers += [first_hit(shapes, origin + by * step, direction) for step in (side, -side, up, -up)]
    if any(math.isinf(a) for a in answers):
        return not all(math.isinf(a) for a in answers)
    return max(answers) - min(answers) > 100 * by
