"""Detects meshes that are boxes, spheres or cylinders, which are fitted to their points."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.parts import Primitive
from morse.assets.shapes.surface import Surface, clean_surface, components, rows_of_three
from morse.mathutils.portable import eigh, matmul, norm, solve
from morse.scene.body import Bounds

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


SMALLEST_HALF = 1e-3
"""Minimum half size of a solid, m, because the physics does not accept flat solids."""


def fit_bounds(vertices: ArrayLike, bounds: Bounds) -> Primitive:
    """The solid of the given kind around the axis-aligned bounding box of a mesh.

    Args:
        vertices: (V, 3) metres; vertices that are not finite are ignored.
        bounds: BOX, SPHERE (radius: the largest half size), CYLINDER, CONE or CAPSULE (along Z; radius: the larger of
            the half sizes in X and Y; a capsule has the length of the box).

    Raises:
        ValueError: there are no vertices, or the bounds are a mesh.
    """
    points: NDArray[np.float64] = rows_of_three(vertices, "vertices").astype(np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ValueError(f"bounds {bounds} need a vertex with finite coordinates, given none")
    low, high = points.min(axis=0), points.max(axis=0)
    centre = (low + high) / 2.0
    x, y, z = np.maximum((high - low) / 2.0, SMALLEST_HALF).tolist()
    match bounds:
        case Bounds.BOX:
            return Primitive("box", (x, y, z), centre)
        case Bounds.SPHERE:
            return Primitive("sphere", (max(x, y, z),), centre)
        case Bounds.CYLINDER:
            return Primitive("cylinder", (max(x, y), z), centre)
        case Bounds.CONE:
            return Primitive("cone", (max(x, y), z), centre)
        case Bounds.CAPSULE:
            radius = max(x, y)
            return Primitive("capsule", (radius, max(z - radius, SMALLEST_HALF)), centre)
    raise ValueError(f"bounds {bounds} are not a primitive: use convex_parts")


def fit_round(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float] | None:
    """Centre (D,) and radius of the circle or sphere through points (P, D) in the least squares sense.

    Linear in the centre c and in r² - c²: I. D. Coope, "Circle fitting by linear and nonlinear least squares", J.
    Optim. Theory Appl. 76 (1993). None if the points do not determine the circle or sphere.
    """
    dimension = points.shape[1]
    if len(points) <= dimension:
        return None
    middle = points.mean(axis=0)
    local = points - middle
    size = float(np.abs(local).max())
    if not size > 0.0:
        return None
    local = local / size
    system = np.column_stack([2.0 * local, np.ones(len(local))])
    solution = solve(matmul(system.T, system), matmul(system.T, (local * local).sum(axis=1)))
    if solution is None:
        return None
    square = float(solution[dimension] + matmul(solution[:dimension], solution[:dimension]))
    if not square > 0.0:
        return None
    return middle + size * solution[:dimension], size * math.sqrt(square)


_OFF = 0.02  # share of the size: tolerance for vertices beside the surface of the solid, for bevels and rounded numbers
_BOX_VOLUME = 0.985  # minimum ratio of the volume of the mesh to the volume of the solid
_SPHERE_VOLUME = 0.8  # an icosphere of 42 vertices has 0.82, a dodecahedron 0.66
_CYLINDER_VOLUME = 0.88  # a prism of eight sides has 0.90, one of six 0.83
_PARALLEL = 1e-3  # radians


def detect_primitive(vertices: ArrayLike, triangles: ArrayLike) -> Primitive | None:
    """Return the box, sphere or cylinder that a mesh represents, in the frame of the mesh, or None.

    For a mesh that is oriented inward (a room) or has several pieces, None is returned.

    Args:
        vertices: (V, 3) metres.
        triangles: (T, 3) indices, counter-clockwise seen from outside.
    """
    surface = clean_surface(vertices, triangles)
    if len(surface.triangles) < 8 or len(components(surface)) != 1:
        return None
    return primitive_of(surface)


def primitive_of(surface: Surface) -> Primitive | None:
    """The box, sphere or cylinder that has the shape of one piece of a surface."""
    volume = surface.signed_volume
    if len(surface.triangles) < 8 or volume <= 0.0:
        return None
    for rotation in _box_frames(surface):
        primitive = _as_box(surface.vertices, volume, rotation)
        if primitive is not None:
            return primitive
    sphere = _as_sphere(surface.vertices, volume)
    if sphere is not None:
        return sphere
    # Similar axes also pass the test; the best fit is used.
    fits = [_as_cylinder(surface.vertices, volume, axis) for axis in _cylinder_axes(surface)]
    best = min((fit for fit in fits if fit is not None), key=lambda fit: fit[1], default=None)
    return None if best is None else best[0]


def _as_box(points: Floats, volume: float, rotation: Floats) -> Primitive | None:
    local = matmul(points, rotation)
    low, high = local.min(axis=0), local.max(axis=0)
    half = (high - low) / 2.0
    centre = (high + low) / 2.0
    if half.min() <= 0.0 or volume < _BOX_VOLUME * 8.0 * half.prod():
        return None
    off = np.abs(np.abs(local - centre) - half).min(axis=1)
    if off.max() > _OFF * half.max():
        return None
    x, y, z = half.tolist()
    return Primitive("box", (x, y, z), matmul(rotation, centre), rotation)


def _box_frames(surface: Surface) -> Iterator[Floats]:
    first = _main_normal(surface.normals, surface.areas)
    across = (np.abs(matmul(surface.normals, first)) < _PARALLEL) & (surface.areas > 0.0)
    if across.any():
        second = _main_normal(surface.normals[across], surface.areas[across])
        second = second - first * (matmul(first, second))
        second /= norm(second)
        yield _nearest_to_frame([first, second, np.cross(first, second)])
    yield np.eye(3)


def _main_normal(normals: Floats, areas: Floats) -> Floats:
    """The normal, up to its sign, of most of the area, to a thousandth."""
    half_space_normals = normals * np.where(_leading_sign(normals) < 0.0, -1.0, 1.0)[:, None]
    keys = np.round(half_space_normals / _PARALLEL).astype(np.int64) + 1024
    _, group = np.unique((keys[:, 0] << 22) + (keys[:, 1] << 11) + keys[:, 2], return_inverse=True)
    group = group.ravel()
    in_main_group = group == np.bincount(group, weights=areas).argmax()
    mean: Floats = matmul(areas[in_main_group], half_space_normals[in_main_group])
    return mean / norm(mean)


def _leading_sign(normals: Floats) -> Floats:
    x, y, z = np.where(np.abs(normals) < 2.0 * _PARALLEL, 0.0, normals).T
    signs: Floats = np.where(x != 0.0, x, np.where(y != 0.0, y, z))
    return signs


def _nearest_to_frame(axes: list[Floats]) -> Floats:
    """The axes as columns of a rotation, each in the column X, Y or Z to which it is closest."""
    rotation = np.zeros((3, 3))
    remaining_axes = list(axes)
    for column in range(2):
        pick = max(range(len(remaining_axes)), key=lambda i: abs(remaining_axes[i][column]))
        axis = remaining_axes.pop(pick)
        rotation[:, column] = axis if axis[column] >= 0.0 else -axis
    rotation[:, 2] = np.cross(rotation[:, 0], rotation[:, 1])
    return rotation


def _as_sphere(points: Floats, volume: float) -> Primitive | None:
    if len(points) < 20:
        return None
    fit = fit_round(points)
    if fit is None:
        return None
    centre, _ = fit
    distance = np.linalg.norm(points - centre, axis=1)
    radius = float(distance.mean())
    if np.abs(distance - radius).max() > _OFF * radius:
        return None
    if volume < _SPHERE_VOLUME * 4.0 / 3.0 * math.pi * radius**3:
        return None
    return Primitive("sphere", (radius,), centre)


def _cylinder_axes(surface: Surface) -> Iterator[Floats]:
    yield from np.eye(3)
    # The caps of a short cylinder have most of the area in one direction …
    yield _main_normal(surface.normals, surface.areas)
    # … and the side of a long cylinder has normals perpendicular to the axis.
    spread = matmul((surface.normals * surface.areas[:, None]).T, surface.normals)
    yield from eigh(spread)[1].T


def _as_cylinder(points: Floats, volume: float, axis: Floats) -> tuple[Primitive, float] | None:
    """The cylinder along an axis, and the largest distance of a vertex from it (as share of its size)."""
    rotation = _frame_along(axis)
    local = matmul(points, rotation)
    low, high = float(local[:, 2].min()), float(local[:, 2].max())
    half, middle = (high - low) / 2.0, (high + low) / 2.0
    flat = local[:, :2]
    fit = fit_round(_outline(flat))
    if fit is None or half <= 0.0:
        return None
    centre, radius = fit
    distance = np.linalg.norm(flat - centre, axis=1)
    off_mantle = np.abs(distance / radius - 1.0)
    off_cap = np.abs(np.abs(local[:, 2] - middle) / half - 1.0)
    on_mantle = off_mantle <= _OFF
    on_cap = (off_cap <= _OFF) & (distance <= (1.0 + _OFF) * radius)
    rims = on_mantle & on_cap
    if not (on_mantle | on_cap).all() or rims.sum() < 12:
        return None
    if not _CYLINDER_VOLUME <= volume / (2.0 * half * math.pi * radius**2) <= 1.0 + _OFF:
        return None
    cylinder = Primitive("cylinder", (radius, half), matmul(rotation, np.array([*centre, middle])), rotation)
    return cylinder, float((off_mantle + off_cap)[rims].mean())


def _outline(flat: Floats) -> Floats:
    """The outermost points (P, 2): the rim, without the inner points of caps."""
    distance = np.linalg.norm(flat - (flat.max(axis=0) + flat.min(axis=0)) / 2.0, axis=1)
    rim: Floats = flat[distance >= 0.9 * distance.max()]
    return rim


def _frame_along(axis: Floats) -> Floats:
    """A rotation whose third column is the axis; the identity for Z."""
    z = axis / norm(axis)
    start = np.eye(3)[0] if abs(z[0]) < 0.9 else np.eye(3)[1]
    x = start - z * (matmul(z, start))
    x /= norm(x)
    return np.column_stack([x, np.cross(z, x), z])
