"""The description of a robot that files of URDF and SDF become: links with masses, joints, shapes.

`morse.assets.robot_nodes` makes nodes of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.errors import AssetError
from morse.mathutils.portable import eigh, matmul
from morse.scene import Inertial

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from morse.mathutils import Matrix
    from morse.scene import JointDynamics, Node
    from morse.scene.articulation import Constraint
    from morse.scene.component import DeclaredSensor


#: maximum number of links, of joints that move, each of which the engine compares with each other, and of joints in a
#: chain
_MOST_LINKS, _MOST_MOVING, _DEEPEST = 2000, 800, 200
#: name of a link that stands for the world: links attached to it are fixed
WORLD = "world"
#: joints that move in several directions
LOOSE = ("floating", "planar", "spherical")


@dataclass(slots=True)
class Shape:
    """A shape of a link.

    Attributes:
        kind: ``box``, ``cylinder``, ``sphere``, ``capsule`` or ``mesh``.
        size: m, as of `morse.scene.CollisionShape`; of a mesh, its scale.
        file: path of a mesh.
        origin: 4x4 in the frame of the link.
        color: RGBA, or None.
    """

    kind: str
    size: tuple[float, ...]
    file: str
    origin: Matrix
    color: tuple[float, float, float, float] | None = None


@dataclass(slots=True)
class Link:
    """A rigid body.

    Attributes:
        inertial: None if the file does not contain it.
        friction: Coulomb coefficient of its shapes; None for the default.
        parts: shapes that are nodes already, from formats with more shapes than URDF.
    """

    name: str
    inertial: Inertial | None = None
    visuals: list[Shape] = field(default_factory=list)
    collisions: list[Shape] = field(default_factory=list)
    parts: list[Node] = field(default_factory=list)
    friction: float | None = None


@dataclass(slots=True)
class Joint:
    """A joint between two links.

    Attributes:
        origin: 4x4 pose of the child in the frame of the parent, at joint value 0.
        axis: unit vector in the frame of the joint.
        dynamics: damping, friction, and limits of the motor.
        mimic: name of the joint that this one follows, factor and offset; or None.
        anchor: 4x4 pose of the joint in the frame of the child; None for the frame of the child itself.
        start: initial value; None for the value next to 0 within the limits.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Matrix
    axis: tuple[float, float, float]
    low: float
    high: float
    dynamics: JointDynamics
    mimic: tuple[str, float, float] | None = None
    anchor: Matrix | None = None
    start: float | None = None

    @property
    def has_value(self) -> bool:
        """Whether a single number determines its position."""
        return self.kind != "fixed" and self.kind not in LOOSE


@dataclass(slots=True)
class RobotDescription:
    """What a file says about a robot.

    Attributes:
        joints: each joint after the one that moves its parent.
        root: the link without a parent.
        warnings: ignored elements, one sentence each.
        fixed: whether the robot is fixed to the world; None if its masses decide.
        constraints: joints that close a loop.
        self_collision: whether its links collide with each other.
        actuators: what its plugins stand for.
        text: the URDF of the robot, see `morse.scene.Articulation`.
        files: URLs of its meshes with their files.
    """

    name: str
    links: dict[str, Link]
    joints: list[Joint]
    root: str
    warnings: list[str]
    sensors: list[DeclaredSensor]
    fixed: bool | None = None
    constraints: tuple[Constraint, ...] = ()
    self_collision: bool = False
    actuators: list[DeclaredSensor] = field(default_factory=list)
    text: str = ""
    files: dict[str, str] = field(default_factory=dict)


def settle_mimics(joints: Sequence[Joint], warn: Callable[[str], None]) -> None:
    """Let each joint that follows another one follow the first of the chain.

    Joints that follow joints that do not exist, or each other, move by themselves.

    Args:
        warn: receives what is left out.
    """
    by_name = {joint.name: joint for joint in joints}
    mimics = {joint.name: joint.mimic for joint in joints}
    for joint in joints:
        if joint.mimic is None:
            continue
        name, factor, offset = joint.mimic
        names = {joint.name}
        while name not in names and (further := mimics.get(name)) is not None:
            names.add(name)
            name, offset, factor = further[0], factor * further[2] + offset, factor * further[1]
        leader = by_name.get(name)
        if leader is None or name in names or not leader.has_value or not joint.has_value:
            warn(f"the joint '{joint.name:.80}' cannot follow '{joint.mimic[0]:.80}'; it moves by itself")
            joint.mimic = None
        else:
            joint.mimic = name, factor, offset


def check_counts(path: Path, links: int, moving: int) -> None:
    """Refuse a robot with too many links, or joints that move.

    Raises:
        AssetError: they exceed a limit.
    """
    if links > _MOST_LINKS:
        raise AssetError(path, f"it has {links} links, more than {_MOST_LINKS}")
    if moving > _MOST_MOVING:
        raise AssetError(
            path, f"it has {moving} joints that move, at most {_MOST_MOVING} can be simulated: fix some of them"
        )


def check_depth(path: Path, depth: int, link: str) -> None:
    """Refuse a chain of too many joints.

    Raises:
        AssetError: it exceeds the limit.
    """
    if depth > _DEEPEST:
        raise AssetError(path, f"there are more than {_DEEPEST} joints in a chain, up to the link '{link:.60}'")


#: kg/m^3; density for the inertia of a link that has a mass but no inertia
_DENSITY = 1000.0
#: tolerance: a moment may exceed the sum of the others by this share of the sum, because files contain rounded numbers
_ROUNDING = 1e-3


def inertial_of(mass: float, origin: Matrix, moments: Sequence[float] | None) -> tuple[Inertial, str]:
    """Return the inertial of a link, and a warning if the file is wrong (else an empty string).

    An inertia that is not positive is replaced by that of a ball of water of the same mass. In a real body no principal
    moment is larger than the sum of the others. If one is larger, the others are enlarged.

    Args:
        mass: kg.
        origin: 4x4, centre of mass and principal axes in the frame of the link.
        moments: ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, kg m^2; None if the file does not contain them.
    """
    x, y, z = origin.translation
    rotation = np.array([list(row) for row in origin.to_3x3()])
    remark = ""
    ball = _ball(mass)
    if moments is None:
        inertia = ball * np.eye(3)
    else:
        xx, yy, zz, xy, xz, yz = moments
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        values, axes = eigh(inertia)
        if values[0] <= 0.0:
            if mass and (values != 0.0).any():
                remark = (
                    f"its inertia has the principal moments {_listed(values.tolist())} kg m^2, expected positive "
                    "numbers; it is replaced by that of a ball"
                )
            inertia = ball * np.eye(3)
        elif values[2] > (values[0] + values[1]) * (1.0 + _ROUNDING):
            remark = (
                f"its inertia has the principal moments {_listed(values.tolist())} kg m^2, and none can be larger "
                f"than the sum of "
                "the others; the smaller ones are enlarged"
            )
            values[:2] += 0.5 * (values[2] - values[0] - values[1])
            inertia = matmul(matmul(axes, np.diag(values)), axes.T)
    inertia = matmul(matmul(rotation, inertia), rotation.T)
    a, b, c, d, e, f, g, h, i = (float(value) for value in inertia.ravel())
    return Inertial(mass, (x, y, z), (a, b, c, d, e, f, g, h, i)), remark


def _ball(mass: float) -> float:
    """Return the moment of inertia of a ball of water, 2/5 m r^2."""
    return 0.4 * mass * math.cbrt(3.0 * mass / (4.0 * math.pi * _DENSITY)) ** 2


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
