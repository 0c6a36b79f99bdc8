"""How a node takes part in the physics."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class PhysicsType(StrEnum):
    """The physics types of scene scripts and model files.

    ``KINEMATIC`` bodies are moved by explicit calls alone, each on its own, wherever they are in the tree: nothing
    moves them, and they push what they meet. Those that are ghosts have no body in the engine: rays and images show
    them.

    ``AUTO`` stands for a file without physics settings. It is resolved when the file is loaded (`morse.assets.rules`),
    so that a built scene does not contain it.
    """

    AUTO = "AUTO"
    NO_COLLISION = "NO_COLLISION"
    STATIC = "STATIC"
    DYNAMIC = "DYNAMIC"
    RIGID_BODY = "RIGID_BODY"
    SENSOR = "SENSOR"
    CHARACTER = "CHARACTER"
    SOFT_BODY = "SOFT_BODY"
    OCCLUDER = "OCCLUDER"
    NAVMESH = "NAVMESH"
    KINEMATIC = "KINEMATIC"


class Bounds(StrEnum):
    """The collision shape wrapped around a mesh."""

    BOX = "BOX"
    SPHERE = "SPHERE"
    CYLINDER = "CYLINDER"
    CONE = "CONE"
    CAPSULE = "CAPSULE"
    CONVEX_HULL = "CONVEX_HULL"
    TRIANGLE_MESH = "TRIANGLE_MESH"
    DECOMPOSITION = "DECOMPOSITION"


@dataclass(slots=True)
class BodySettings:
    """Physics settings of one node.

    Attributes:
        type: see `PhysicsType`.
        bounds: collision shape, or None to detect one from the mesh.
        compound: whether the shapes of the children belong to this body.
        mass: kg.
        radius: radius of the sphere that represents a body without a mesh, m.
        friction: Coulomb coefficient, or None for the default of the simulation.
        restitution: 0 (no bounce) to 1, or None for the default of the simulation, at which bodies bounce a little.
        linear_damping: share of the linear velocity lost each second, 0..1.
        angular_damping: share of the angular velocity lost each second, 0..1.
        ghost: whether contacts are reported but exert no force.
        actor: whether sensors detect it.
        lock_location: world axes along which the body cannot move.
        lock_rotation: world axes about which the body cannot turn.
        gravity: whether gravity acts on the body.
    """

    type: PhysicsType = PhysicsType.NO_COLLISION
    bounds: Bounds | None = None
    compound: bool = False
    mass: float = 1.0
    radius: float = 1.0
    friction: float | None = None
    restitution: float | None = None
    linear_damping: float = 0.04
    angular_damping: float = 0.1
    ghost: bool = False
    actor: bool = True
    lock_location: tuple[bool, bool, bool] = (False, False, False)
    lock_rotation: tuple[bool, bool, bool] = (False, False, False)
    gravity: bool = True

    @property
    def moves(self) -> bool:
        """Whether the body is dynamic."""
        return self.type in (PhysicsType.DYNAMIC, PhysicsType.RIGID_BODY, PhysicsType.CHARACTER, PhysicsType.SOFT_BODY)

    @property
    def collides(self) -> bool:
        """Whether other bodies collide with the body."""
        return (self.moves or self.type in (PhysicsType.STATIC, PhysicsType.KINEMATIC)) and not self.ghost


_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class ShapeKind(StrEnum):
    """The shapes that the physics supports."""

    BOX = "box"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    CAPSULE = "capsule"
    ELLIPSOID = "ellipsoid"
    CONVEX = "convex"
    HEIGHT_FIELD = "height field"


@dataclass(eq=False, slots=True, weakref_slot=True)
class CollisionShape:
    """One convex piece of a body, or a height field.

    Attributes:
        size: metres. Box and ellipsoid: three half sizes; sphere: radius; cylinder and capsule:
            radius and half length (of the straight part) along Z; convex: empty; height field: half sizes along X and
            Y, largest height, thickness below height 0.
        position: position of its centre in the frame of the node.
        rotation: row-major 3x3 rotation from the shape to the node.
        vertices: (V, 3) points whose hull is the shape, in the frame of the node (only for convex shapes).
        heights: (R, C) heights of at least 0, m; rows along Y, columns along X (height field only).
    """

    kind: ShapeKind
    size: tuple[float, ...]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float, float, float, float, float, float] = _IDENTITY
    vertices: NDArray[np.float64] | None = None
    heights: NDArray[np.float64] | None = None
