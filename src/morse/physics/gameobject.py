"""The handle that components hold of an object in the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.mathutils import Matrix, Vector
from morse.physics import rigid
from morse.physics.children import ObjectList
from morse.physics.convert import floats3
from morse.physics.drive import Command
from morse.physics.layout import Motion
from morse.physics.names import LegacyNames
from morse.physics.wheelhandle import Wheel, wheels_of
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.physics.world import World
    from morse.scene import Node

_ORIGIN = (0.0, 0.0, 0.0)
_Pose = tuple["Sequence[float]", "Sequence[float]"]


class GameObject(LegacyNames):
    """An object of the running world: its pose, velocity, properties and children.

    Positions are metres, rotations are 3x3 matrices, velocities m/s and rad/s. "World" values
    are in the axes of the world, "local" ones in the axes of the parent (poses) or of the
    object itself (velocities and forces). The attribute names are those that components of
    MORSE 1.4 use.

    Attributes:
        node: the node of the scene that this object came from.
        slot: index of the rigid group that it moves with.
    """

    def __init__(self, world: World, node: Node, slot: int) -> None:
        self._world = world
        self.node = node
        self.slot = slot
        self.properties: dict[str, Any] = dict(node.properties)
        # poses in the parent's frame are what counts: those in the rigid group follow from them, so
        # that turning a part again and again adds no rounding errors
        self._local: _Pose = (_ORIGIN, rigid.IDENTITY)
        self._offset: _Pose | None = None
        self._stamp = -1
        self._pose: _Pose = (_ORIGIN, rigid.IDENTITY)
        self._is_turned = False
        self._start_local, self._start_offset = self._poses_of_scene()
        self.visible = node.visible

    def _poses_of_scene(self) -> tuple[_Pose, _Pose | None]:
        """The pose in the parent's frame, and that in the rigid group (None for its first node)."""
        frame = self._world.slots[self.slot]
        if frame.frame.node is self.node:
            return (_ORIGIN, rigid.IDENTITY), None
        own, parent = rigid_frame(self.node), self.node.parent
        outer = frame.pose if parent is None or parent is frame.frame.node else rigid_frame(parent)
        pose = (tuple(own.position), _flat(own.rotation))
        return (
            rigid.relative(tuple(outer.position), _flat(outer.rotation), *pose),
            rigid.relative(tuple(frame.pose.position), _flat(frame.pose.rotation), *pose),
        )

    def restore(self) -> None:
        """Back to what the scene says; called by the reset of the world."""
        self._local = self._start_local
        self._take_offset(self._start_offset)
        self._stamp = -1
        self.properties = dict(self.node.properties)
        self.visible = self.node.visible

    # -- identity --------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The name in the scene."""
        return self.node.name

    @property
    def is_dynamic(self) -> bool:
        """Whether it obeys forces."""
        return self._world.slots[self.slot].frame.motion is Motion.FREE

    @property
    def mass(self) -> float:
        """kg; 0 for what does not obey forces."""
        slot = self._world.slots[self.slot]
        return float(self._world.model.body_mass[slot.body]) if self.is_dynamic and slot.body > 0 else 0.0

    @property
    def localInertia(self) -> Vector:  # noqa: N802
        """Principal moments of inertia, kg m^2."""
        slot = self._world.slots[self.slot]
        return Vector(self._world.model.body_inertia[slot.body].tolist() if slot.body > 0 else _ORIGIN)

    def __repr__(self) -> str:
        return self.name

    # -- tree ------------------------------------------------------------------------------

    @property
    def parent(self) -> GameObject | None:
        """What it is attached to, in the scene or since then."""
        if self._leads:
            holder = self._world.attachments.holder(self.slot)
            if holder is not None:
                return holder
        return self._world.object_of(self.node.parent) if self.node.parent is not None else None

    @property
    def children(self) -> ObjectList:
        """The objects attached to it."""
        return ObjectList([self._world.object_of(child) for child in self.node.children])

    @property
    def childrenRecursive(self) -> ObjectList:  # noqa: N802
        """The objects attached to it, to those, and so on."""
        return ObjectList([self._world.object_of(node) for node in self.node.walk() if node is not self.node])

    def setParent(self, parent: GameObject, compound: bool = True, ghost: bool = True) -> None:  # noqa: N802
        """Hang this object, as it is now, on another one."""
        if self._leads:
            self._world.attachments.hold(self.slot, parent)

    def removeParent(self) -> None:  # noqa: N802
        """Let go of what `setParent` hung it on."""
        self._world.attachments.release(self.slot)

    # -- properties ------------------------------------------------------------------------

    def __getitem__(self, name: str) -> Any:
        return self.properties[name]

    def __setitem__(self, name: str, value: Any) -> None:
        self.properties[name] = value

    def __delitem__(self, name: str) -> None:
        del self.properties[name]

    def __contains__(self, name: object) -> bool:
        return name in self.properties

    def __iter__(self) -> Iterator[str]:
        return iter(self.properties)

    def get(self, name: str, default: Any = None) -> Any:
        """A property, or ``default``."""
        return self.properties.get(name, default)

    def getPropertyNames(self) -> list[str]:  # noqa: N802
        """The names of the properties."""
        return list(self.properties)

    # -- pose ------------------------------------------------------------------------------

    def world_pose(self) -> _Pose:
        """Position (3) and rotation (9, row-major) in the world, as plain floats."""
        world = self._world
        if self._stamp != world.stamp:
            position, rotation = world.positions[self.slot], world.rotations[self.slot]
            if self._offset is None:
                self._pose = (position, rotation)
            elif self._is_turned:
                self._pose = rigid.compose(position, rotation, *self._offset)
            else:
                x, y, z = rigid.turn(rotation, self._offset[0])
                self._pose = ((position[0] + x, position[1] + y, position[2] + z), rotation)
            self._stamp = world.stamp
        return self._pose

    @property
    def _leads(self) -> bool:
        """Whether it is the first node of its rigid group."""
        return self._world.slots[self.slot].frame.node is self.node

    def local_pose(self) -> _Pose:
        """Position (3) and rotation (9) in the frame of the parent."""
        if not self._leads:
            return self._local
        parent = self.parent
        return self.world_pose() if parent is None else rigid.relative(*parent.world_pose(), *self.world_pose())

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Put the object, and what is attached to it, somewhere in the world; its velocity stays."""
        world = self._world
        if self._leads:
            world.place(self.slot, position, rotation)
            world.attachments.moved(self.slot)
            return
        assert self.node.parent is not None
        outer = world.object_of(self.node.parent).world_pose()
        self._set_local(rigid.relative(*outer, position, rotation))

    def set_local_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Put the object somewhere in the frame of its parent."""
        if not self._leads:
            self._set_local((position, rotation))
            return
        parent = self.parent
        placed = (position, rotation)
        self.set_pose(*(placed if parent is None else rigid.compose(*parent.world_pose(), *placed)))

    def _set_local(self, pose: _Pose) -> None:
        self._local = pose
        self._follow()
        self._world.note_displaced(self)

    def _follow(self) -> None:
        """Work out the pose in the rigid group anew, from here downward."""
        world = self._world
        assert self.node.parent is not None
        outer = world.object_of(self.node.parent)
        self._take_offset(rigid.compose(*outer.offset, *self._local))
        self._stamp = -1
        world.move_shapes(self)
        for child in self.node.children:
            below = world.object_of(child)
            if below.slot == self.slot:
                below._follow()

    def _take_offset(self, offset: _Pose | None) -> None:
        # most components sit on their robots unturned, many at its origin: their poses cost less
        self._is_turned = offset is not None and _differ(offset[1], rigid.IDENTITY)
        self._offset = offset if offset is not None and (self._is_turned or _differ(offset[0], _ORIGIN)) else None

    @property
    def offset(self) -> _Pose:
        """Position and rotation in the rigid group it belongs to."""
        return self._offset or (_ORIGIN, rigid.IDENTITY)

    # -- velocity and forces ---------------------------------------------------------------

    def velocity(self) -> tuple[Sequence[float], Sequence[float]]:
        """Linear and angular velocity of its origin, in world axes."""
        linear, angular = self._world.velocity(self.slot)
        if self._offset is not None:
            origin, here = self._world.positions[self.slot], self.world_pose()[0]
            arm = (here[0] - origin[0], here[1] - origin[1], here[2] - origin[2])
            x, y, z = rigid.cross(angular, arm)
            linear = (linear[0] + x, linear[1] + y, linear[2] + z)
        return linear, angular

    def drive(
        self, linear: Sequence[float], angular: Sequence[float], *, position: bool = False, ground: bool = False
    ) -> None:
        """Move with a velocity, in its own axes, during the next tick.

        Args:
            position: without gaining momentum.
            ground: leave the vertical speed and the roll and pitch rates to gravity and contacts.
        """
        self._world.drives.command(
            self.slot, Command(floats3(linear, "linear speed"), floats3(angular, "angular speed"), position, ground)
        )

    def halt(self) -> None:
        """Come to rest."""
        self._world.drives.cancel(self.slot)
        self._world.set_velocity(self.slot, _ORIGIN, _ORIGIN)

    def wrench(self, force: Sequence[float], torque: Sequence[float], local: bool) -> None:
        """Push the body at its centre of mass during the next tick, N and N m."""
        force, torque = floats3(force, "force"), floats3(torque, "torque")
        if local:
            rotation = self.world_pose()[1]
            force, torque = rigid.turn(rotation, force), rigid.turn(rotation, torque)
        self._world.apply_wrench(self.slot, force, torque)

    def pull(
        self, anchor: Sequence[float], target: Sequence[float], stiffness: float, damping: float, strongest: float
    ) -> None:
        """Pull a point of the body towards a place during the next tick, as a damped spring does.

        Args:
            anchor: the point, in the frame of the object, m.
            target: the place in the world, m.
            stiffness: spring constant divided by the mass, 1/s^2.
            damping: damping constant divided by the mass, 1/s.
            strongest: largest acceleration, m/s^2.
        """
        self._world.pull(self, floats3(anchor, "anchor"), floats3(target, "target"), stiffness, damping, strongest)

    def suspendDynamics(self, ghost: bool = False) -> None:  # noqa: N802
        """Stay where it is, whatever acts on it."""
        self._world.attachments.suspend(self.slot)

    def restoreDynamics(self) -> None:  # noqa: N802
        """Obey the physics again."""
        self._world.attachments.resume(self.slot)

    @property
    def isSuspendDynamics(self) -> bool:  # noqa: N802
        """Whether it is kept where it is."""
        return self._world.attachments.is_suspended(self.slot)

    def disable_gravity(self) -> None:
        """Do not fall any more."""
        self._world.set_weightless(self.slot)

    def wheels(self) -> list[Wheel]:
        """The driven wheels of a wheeled robot."""
        return wheels_of(self._world, self)

    # -- looking around --------------------------------------------------------------------

    def getDistanceTo(self, other: GameObject | Sequence[float]) -> float:  # noqa: N802
        """Distance between origins, m."""
        return math.dist(self.world_pose()[0], _point(other))

    def getVectTo(self, other: GameObject | Sequence[float]) -> tuple[float, Vector, Vector]:  # noqa: N802
        """Distance (m) and unit vector to an object or point, in world axes and in its own."""
        position, rotation = self.world_pose()
        target = _point(other)
        delta = tuple(b - a for a, b in zip(position, target, strict=True))
        distance = math.sqrt(sum(d * d for d in delta))
        unit = tuple(d / distance for d in delta) if distance else _ORIGIN
        return distance, Vector(unit), Vector(rigid.turn_back(rotation, unit))

    def rayCast(  # noqa: N802
        self,
        objto: GameObject | Sequence[float],
        objfrom: GameObject | Sequence[float] | None = None,
        dist: float = 0.0,
        prop: str = "",
        face: int = 0,
        xray: int = 0,
        poly: int = 0,
    ) -> tuple[GameObject | None, Vector | None, Vector | None]:
        """The first thing on the way to a point: object, hit point and normal, or three None.

        Args:
            dist: look that far, in metres, also beyond the target; 0 for up to the target.
            prop: only stop at objects that have this property.
            xray: see through the objects that have not.
        """
        start = self.world_pose()[0] if objfrom is None else _point(objfrom)
        return self._world.cast(start, _point(objto), dist, prop, bool(xray), self)

    def rayCastTo(  # noqa: N802
        self, other: GameObject | Sequence[float], dist: float = 0.0, prop: str = ""
    ) -> GameObject | None:
        """The first thing on the way to a point, or None."""
        return self.rayCast(other, None, dist, prop)[0]

    def setVisible(self, visible: bool, recursive: bool = False) -> None:  # noqa: N802
        """Show or hide it."""
        self.visible = bool(visible)
        self._world.appearance_changed(self)
        if recursive:
            for child in self.childrenRecursive:
                child.setVisible(visible)


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    return max(abs(x - y) for x, y in zip(a, b, strict=True)) > 1e-14


def _flat(matrix: Matrix) -> tuple[float, ...]:
    return tuple(value for row in matrix for value in row)


def _point(place: Any) -> tuple[float, float, float]:
    if isinstance(place, GameObject):
        x, y, z = place.world_pose()[0]
        return x, y, z
    return floats3(place, "point")
