"""The parts into which a mesh is decomposed: convex pieces, and hulls of pieces that are not convex."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from morse.assets.shapes.surface import edge_neighbours
from morse.mathutils import portable
from morse.mathutils.portable import eigh, matmul
from morse.scene.body import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.surface import Surface

    Floats = NDArray[np.float64]


PrimitiveKind: TypeAlias = Literal["box", "sphere", "cylinder", "capsule", "cone"]

CONE_SIDES = 24  # the physics has no cones: a cone becomes a pyramid with this number of sides


@dataclass(eq=False, slots=True)
class Primitive:
    """A simple solid in the frame of the mesh.

    Attributes:
        size: metres. Box: three half sizes; sphere: radius; cylinder and cone: radius and half height; capsule: radius
            and half length of its straight part. Cylinder, cone (tip up) and capsule are along Z.
        position: (3,) position of its centre.
        rotation: (3, 3) rotation from the frame of the solid to that of the mesh.
    """

    kind: PrimitiveKind
    size: tuple[float, ...]
    position: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    rotation: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))

    def to_shape(self) -> CollisionShape:
        """Return the shape for the physics."""
        if self.kind == "cone":
            return ConvexPart(self._cone_points()).to_shape()
        x, y, z = self.position.tolist()
        a, b, c, d, e, f, g, h, i = self.rotation.ravel().tolist()
        return CollisionShape(ShapeKind(self.kind), self.size, (x, y, z), (a, b, c, d, e, f, g, h, i))

    def _cone_points(self) -> NDArray[np.float64]:
        radius, half = self.size
        turn = np.arange(CONE_SIDES) * (2.0 * math.pi / CONE_SIDES)
        base = np.column_stack([radius * portable.cos(turn), radius * portable.sin(turn), np.full(CONE_SIDES, -half)])
        return np.asarray(matmul(np.vstack([base, [0.0, 0.0, half]]), self.rotation.T) + self.position)


@dataclass(eq=False, slots=True)
class ConvexPart:
    """The convex hull of points.

    Attributes:
        points: (P, 3) metres, in the frame of the mesh; not all in one plane.
    """

    points: NDArray[np.float64]

    def to_shape(self) -> CollisionShape:
        """Return the shape for the physics."""
        return CollisionShape(ShapeKind.CONVEX, (), vertices=self.points)


Part: TypeAlias = Primitive | ConvexPart


_BULGE = 1e-3  # share of the diagonal: tolerance for vertices in front of a face
_WORK = 20_000_000  # maximum product of vertices and faces that are tested
_CHUNK = 2_000_000
_HULL_POINTS = 512  # maximum number of vertices of a hull; of a larger hull, only the extreme vertices are used
_ALL_POINTS, _FEWEST_POINTS = (
    262_144,
    64,
)  # of many hulls together, and of each of them: the engine takes 250 B for each
_ROUNDING = 1e-12  # share of the cube of the trace of a matrix by which its determinant may be wrong
_THINNEST = 0.001  # metres; minimum thickness of hulls


def is_convex(surface: Surface) -> bool:
    """Whether one piece of a surface is closed, oriented outward, and no vertex lies in front of a face."""
    if surface.signed_volume <= 0.0 or not surface.is_closed:
        return False
    tolerance = _BULGE * surface.diagonal
    faces = np.flatnonzero(surface.areas > 0.0)
    offsets = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.triangles[:, 0]])
    step = max(1, len(faces) * len(surface.vertices) // _WORK)
    if step > 1 and not _bends_backward(surface, offsets, tolerance):
        return False
    sample = faces[::step]
    for chunk in np.array_split(sample, max(1, len(sample) * len(surface.vertices) // _CHUNK)):
        heights = matmul(surface.vertices, surface.normals[chunk].T) - offsets[chunk]
        if heights.max() > tolerance:
            return False
    return True


def _bends_backward(surface: Surface, offsets: Floats, tolerance: float) -> bool:
    """True if no triangle is in front of the plane of its neighbours."""
    for across in edge_neighbours(surface).T:
        corners = surface.corners[across]
        heights = np.einsum("tcj,tj->tc", corners, surface.normals) - offsets[:, None]
        if heights.max() > tolerance:
            return False
    return True


def hull_part(points: Floats, hulls: int = 1, *, most: int = _HULL_POINTS) -> ConvexPart:
    """The convex hull of points (P, 3), thickened if they lie in a plane, with few enough points for the physics.

    Args:
        hulls: number of hulls that share the memory of the physics.
        most: maximum number of points, about.
    """
    most = min(most, max(_FEWEST_POINTS, _ALL_POINTS // hulls))
    if len(points) > most:
        points = _extreme_points(points, most)
    return ConvexPart(thickened(points, _THINNEST))


def thickened(points: Floats, least: float) -> Floats:
    """Return points (P, 3) whose hull has at least the thickness ``least``, m, along each principal axis.

    Points that lie too close to a plane, a line or a point are duplicated, and one copy is moved to each side.
    """
    centre = points.mean(axis=0)
    scatter = matmul((points - centre).T, points - centre)
    if least < _least_width(scatter, len(points)):
        return points
    _, axes = eigh(scatter)
    for axis in axes.T:
        lacking = least - float(np.ptp(matmul(points - centre, axis)))
        if lacking > 0.0:
            points = np.vstack([points - axis * (lacking / 2.0), points + axis * (lacking / 2.0)])
    return points


def _least_width(scatter: Floats, count: int) -> float:
    """A lower bound of the width along each principal axis of points with a matrix of second moments, m.

    The product of the two larger eigenvalues is at most the square of half of the trace, and half of the width is at
    least the root of the mean square. Most parts are thick enough, and need no eigenvectors.
    """
    (a, b, c), (_, d, e), (_, _, f) = scatter.tolist()
    trace = a + d + f
    volume = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d) - _ROUNDING * trace**3
    return 2.0 * math.sqrt(max(volume, 0.0) / count) / (trace / 2.0) if 0.0 < trace < math.inf else 0.0


def _extreme_points(points: Floats, most: int) -> Floats:
    """About ``most`` of the points (P, 3), extreme in directions that are spread evenly over the sphere."""
    scale = np.maximum(np.ptp(points, axis=0), 1e-12)
    outward = directions(most) / scale
    chunks = np.array_split(outward, max(1, len(points) * len(outward) // _CHUNK))
    extreme = [matmul(points, chunk.T).argmax(axis=0) for chunk in chunks if len(chunk)]
    extreme_points: Floats = points[np.unique(np.concatenate(extreme))]
    return extreme_points


@cache
def directions(count: int) -> Floats:
    """Directions (count + 6, 3): a Fibonacci lattice, and the axes."""
    index = np.arange(count) + 0.5
    height = 1.0 - 2.0 * index / count
    turn = index * (math.pi * (1.0 + math.sqrt(5.0)))
    around = np.sqrt(1.0 - height**2)
    lattice = np.column_stack([around * portable.cos(turn), around * portable.sin(turn), height])
    return np.vstack([lattice, np.eye(3), -np.eye(3)])
