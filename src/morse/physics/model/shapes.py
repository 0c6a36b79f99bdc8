"""Shapes of bodies: their masses, the masks by which they collide, hulls that the engine cannot compute, and wheels.

The bits of a shape from an MJCF file are those of the file, so that shapes of files touch as the files say. They touch
all other shapes, because these have the bits of `ALL_BITS`.
"""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import mujoco
import numpy as np

from morse.mathutils.portable import matmul, norm
from morse.physics.poses.rigid import as_array
from morse.scene import CollisionShape, ShapeKind
from morse.scene.extent import box_around
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.scene import Node, Scene


#: height of the centre of mass of a driven robot as a share of its height; it is low because batteries and motors are
#: mounted low, and because the robot would topple too easily otherwise
ROBOT_CENTRE_HEIGHT = 0.2


#: volumes of convex hulls, which are asked for again whenever an object is spawned or deleted
_volumes: WeakKeyDictionary[CollisionShape, float] = WeakKeyDictionary()


def volume(shape: CollisionShape) -> float:
    """Return the volume of a shape, m^3 (for a convex hull, of its bounding box)."""
    s = shape.size
    match shape.kind:
        case ShapeKind.BOX:
            return 8 * s[0] * s[1] * s[2]
        case ShapeKind.SPHERE:
            return 4 / 3 * math.pi * s[0] ** 3
        case ShapeKind.ELLIPSOID:
            return 4 / 3 * math.pi * s[0] * s[1] * s[2]
        case ShapeKind.CYLINDER:
            return 2 * math.pi * s[0] ** 2 * s[1]
        case ShapeKind.CAPSULE:
            return 2 * math.pi * s[0] ** 2 * s[1] + 4 / 3 * math.pi * s[0] ** 3
        case ShapeKind.HEIGHT_FIELD:
            return 4 * s[0] * s[1] * (s[2] / 2 + s[3])
        case ShapeKind.CONVEX:
            value = _volumes.get(shape)
            if value is None:
                assert shape.vertices is not None
                value = _volumes[shape] = float(np.prod(np.maximum(np.ptp(shape.vertices, axis=0), 1e-3)))
            return value


def half_sizes(shape: CollisionShape) -> NDArray[np.float64]:
    """Return the half sizes (3,) of the box around a primitive, in its own frame, m."""
    s = shape.size
    match shape.kind:
        case ShapeKind.SPHERE:
            return np.full(3, s[0])
        case ShapeKind.CYLINDER:
            return np.array([s[0], s[0], s[1]])
        case ShapeKind.CAPSULE:
            return np.array([s[0], s[0], s[1] + s[0]])
        case ShapeKind.HEIGHT_FIELD:
            return np.array([s[0], s[1], max(s[2], s[3])])
        case _:
            return np.asarray(s, dtype=np.float64)


def robot_inertia(
    mass: float, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the centre of mass (3,) and the principal inertia (3,) of a robot that fills a box.

    The inertia is that of a solid box (m/12 (b^2 + c^2)). For the height of the centre see `ROBOT_CENTRE_HEIGHT`.
    """
    size = np.maximum(upper - lower, 0.02)
    centre = (lower + upper) / 2
    centre[2] = lower[2] + ROBOT_CENTRE_HEIGHT * (upper[2] - lower[2])
    squares = size**2
    return centre, mass / 12 * (squares.sum() - squares)


#: density of links without masses in the file, kg/m^3
_DENSITY = 1000.0


def mass_of(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return mass (kg), centre (3,) and inertia (3, 3) about the centre of a shape with the density of water.

    The inertia is that of a solid box of the size of the shape.

    Args:
        position: position of the node in the wanted frame, m.
        rotation: (3, 3) rotation of the node in the wanted frame.
    """
    mass = _DENSITY * volume(shape)
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        centre, half, shape_rotation = (low + high) / 2.0, (high - low) / 2.0, rotation
    else:
        centre, half = np.asarray(shape.position), half_sizes(shape)
        shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    squares = (2.0 * half) ** 2
    moments = mass / 12.0 * (squares.sum() - squares)
    return (
        mass,
        position + matmul(rotation, centre),
        matmul(matmul(shape_rotation, np.diag(moments)), shape_rotation.T),
    )


def moved_inertia(inertia: NDArray[np.float64], mass: float, by: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inertia (3, 3) about a point at a distance from the centre of mass (parallel axis theorem)."""
    return np.asarray(inertia + mass * (float(matmul(by, by)) * np.eye(3) - np.outer(by, by)))


#: masks have 31 bits: one for all shapes that are not floors, others for floors and planes, then those of files
MOST_FLOORS, MOST_PLANES, _MOST_OF_FILES = 14, 4, 11
#: bits of shapes that touch everything except planes
ALL_BITS = (1 << (MOST_FLOORS + 1)) - 1
#: bit of the first plane; see `morse.physics.gliding.floors`
FIRST_PLANE = 1 << (MOST_FLOORS + 1)
_FIRST_OF_FILES = MOST_FLOORS + 1 + MOST_PLANES
#: bit of all shapes from files
OF_FILE = 1 << 30


def file_bits(geoms: Iterable[mujoco.MjsGeom]) -> None:
    """Replace the masks of the geoms of a file."""
    used = 0
    for geom in geoms:
        used |= geom.contype | geom.conaffinity
    bits = [bit for bit in range(32) if used & (1 << bit)]
    # with more bits, the last ones are shared
    place = {bit: 1 << (_FIRST_OF_FILES + min(number, _MOST_OF_FILES - 1)) for number, bit in enumerate(bits)}
    for geom in geoms:
        kinds, partners = geom.contype, geom.conaffinity
        if kinds or partners:
            geom.contype = OF_FILE | sum({place[bit] for bit in bits if kinds & (1 << bit)})
            geom.conaffinity = ALL_BITS | sum({place[bit] for bit in bits if partners & (1 << bit)})


logger = logging.getLogger(__name__)


_SMALLEST_HALF = 1e-3
_NAMED = 5


def replace_unusable_hulls(scene: Scene) -> bool:
    """Remove all convex shapes that the engine refuses, and log one warning with the names of the objects.

    Moving bodies need a shape for their inertia, so they get the box around the points instead.

    Returns:
        Whether any shape was removed.
    """
    unusable: dict[int, bool] = {}
    concerned: list[Node] = []
    for node in scene.nodes():
        bad_shapes = [shape for shape in node.shapes or () if _is_unusable(shape, unusable)]
        if bad_shapes:
            concerned.append(node)
            good_shapes = [shape for shape in node.shapes or () if shape not in bad_shapes]
            node.shapes = good_shapes + [_box_around(shape) for shape in bad_shapes if node.body.moves]
    if concerned:
        names = ", ".join(f"'{node.name}'" for node in concerned[:_NAMED])
        more = f" and {len(concerned) - _NAMED} more" if len(concerned) > _NAMED else ""
        logger.warning(
            "%s%s: parts of the mesh are too thin for the physics and are left out or collide as boxes; "
            "give the object a collision shape of its own (game physics bounds, or a property 'collision')",
            names,
            more,
            extra={"where": concerned[0].line},
        )
    return bool(concerned)


def _is_unusable(shape: CollisionShape, cache: dict[int, bool]) -> bool:
    if shape.kind is not ShapeKind.CONVEX:
        return False
    if id(shape) not in cache:
        cache[id(shape)] = _is_refused(shape)
    return cache[id(shape)]


def _is_refused(shape: CollisionShape) -> bool:
    spec = mujoco.MjSpec()
    vertices = np.ascontiguousarray(shape.vertices, dtype=np.float32).ravel()
    spec.add_mesh(name="hull", uservert=vertices, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull")
    try:
        spec.compile()
    except ValueError:
        return True
    return False


def _box_around(shape: CollisionShape) -> CollisionShape:
    assert shape.vertices is not None
    points = np.asarray(shape.vertices, dtype=np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    half, centre = np.maximum((high - low) / 2.0, _SMALLEST_HALF), (high + low) / 2.0
    return CollisionShape(ShapeKind.BOX, tuple(half.tolist()), tuple(centre.tolist()))


def _rotation(node: Node) -> NDArray[np.float64]:
    return as_array(rigid_frame(node).rotation)


def wheel_axis(wheel: Node, robot: Node) -> NDArray[np.float64]:
    """Return the axle (3,) in the frame of the wheel: the Y axis of the robot, so that positive speed is forward."""
    return np.asarray(matmul(_rotation(wheel).T, _rotation(robot)[:, 1]))


def wheel_size(wheel: Node, axis: NDArray[np.float64]) -> tuple[float, float, NDArray[np.float64]]:
    """Return radius and half width of the shapes of a wheel, m, and the rotation (3, 3) from Z to the axle."""
    z = axis / norm(axis)
    helper = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = np.cross(helper, z)
    x /= norm(x)
    rotation = np.column_stack([x, np.cross(z, x), z])
    lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
    for shape in wheel.shapes or ():
        low, high = box_around(shape, np.zeros(3), rotation.T)
        lower, upper = np.minimum(lower, low), np.maximum(upper, high)
    half = (upper - lower) / 2
    return float(max(half[0], half[1])), float(half[2]), rotation
