"""The handle of components for an object in the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

from morse.mathutils import Matrix, Vector
from morse.physics.driving.command import Command
from morse.physics.model.layout import Motion
from morse.physics.objects.joint_handle import JointHandle
from morse.physics.objects.legacy_names import LegacyNames
from morse.physics.objects.object_world import ObjectList, RemovedWorld
from morse.physics.objects.properties import Looks, are_changed, plain_properties, scene_properties
from morse.physics.objects.wheel import Wheel
from morse.physics.poses import rigid
from morse.physics.poses.convert import (
    ANGULAR_VELOCITY,
    FORCE,
    POINT,
    POSITION,
    TORQUE,
    VELOCITY,
    demand_rotation,
    floats3,
)
from morse.physics.poses.rigid import Mounting
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.core.values import Properties, StateData, Value
    from morse.physics.objects.object_world import ObjectWorld, Posed
    from morse.physics.state.saved import SavedObject
    from morse.scene import Node
    from morse.scene.frames import RigidFrame

_ORIGIN = (0.0, 0.0, 0.0)
_Pose = tuple["Sequence[float]", "Sequence[float]"]


class _OnDemand:
    """The mounting of an object whose mounting was invalidated; an attribute of the object takes precedence."""

    def __get__(self, obj: GameObject | None, owner: type) -> Mounting | _OnDemand:
        if obj is None:
            return self
        mounting = obj.mounting = Mounting.of(obj._carried_offset())
        return mounting


class GameObject(LegacyNames):
    """An object of the running world: its pose, velocity, properties and children.

    Positions are metres, rotations are 3x3 matrices, velocities m/s and rad/s. "World" values
    are in the axes of the world, "local" ones in the axes of the parent (poses) or of the
    object itself (velocities and forces). The attribute names are those of MORSE 1.4.

    Attributes:
        node: the node of the scene for this object.
        slot: index of the rigid group of the object.
        mounting: pose of the object in that group.
    """

    mounting: Mounting

    def __init__(self, world: ObjectWorld, node: Node, slot: int) -> None:
        self._world = world
        self.properties: Properties = scene_properties(node)
        # poses in the frame of the parent are stored, and poses in the rigid group are derived from them, so that
        # rotating a part repeatedly does not accumulate rounding errors
        self._local: _Pose = (_ORIGIN, rigid.IDENTITY)
        self.mounting = Mounting.of(None)
        self._stamp = -1
        self._frames: tuple[RigidFrame, RigidFrame, RigidFrame] | None = None
        self._start_local: _Pose
        self._start_mounting = self.mounting
        self._pose: _Pose = (_ORIGIN, rigid.IDENTITY)
        self._is_displaced = False
        self.visible = node.visible
        self.node = node
        self._looks = Looks(node)
        self.belong(node, slot)

    def belong(self, node: Node, slot: int) -> None:
        """Bind the object to a node and a slot, also after a change of the scene."""
        if node is not self.node:
            self.node, self._looks = node, Looks(node)
        self.slot = slot
        self._leads = self._world.slots[slot].frame.node is node
        self._moved_along: tuple[list[GameObject], list[GameObject]] | None = None
        self._take_poses_of_scene()

    def remove(self) -> None:
        """Mark the object as removed from the world: further use of it raises an error."""
        self._looks.restore()
        self._world = cast("ObjectWorld", RemovedWorld(self.name))

    @property
    def invalid(self) -> bool:
        """Whether it has been removed from the world."""
        return isinstance(self._world, RemovedWorld)

    def _take_poses_of_scene(self) -> None:
        """Compute the pose in the frame of the parent, and the pose in the rigid group (None for its first node)."""
        frame = self._world.slots[self.slot]
        if frame.frame.node is self.node:
            self._frames = None
            self._start_local, self._start_mounting = (_ORIGIN, rigid.IDENTITY), Mounting.of(None)
            return
        own, parent = rigid_frame(self.node), self.node.parent
        outer = frame.pose if parent is None or parent is frame.frame.node else rigid_frame(parent)
        before = self._frames
        if before is not None and before[0] is own and before[1] is outer and before[2] is frame.pose:
            return  # another object has come or gone
        self._frames = own, outer, frame.pose
        pose = (tuple(own.position), _flat(own.rotation))
        self._start_local = rigid.relative(tuple(outer.position), _flat(outer.rotation), *pose)
        offset = rigid.relative(tuple(frame.pose.position), _flat(frame.pose.rotation), *pose)
        self._start_mounting = Mounting.of(offset)

    def restore(self) -> None:
        """Restore the values of the scene; called by the reset of the world."""
        self._local = self._start_local
        self.mounting = self._start_mounting
        self._stamp = -1
        self._is_displaced = False
        self._world.displacements += 1
        self.properties = scene_properties(self.node)
        self.visible = self.node.visible
        if self._looks.restore():
            self._world.appearance_changed(self)

    # -- saving ----------------------------------------------------------------------------

    def get_state(self) -> StateData:
        """Return the differences from the scene; see `morse.physics.state.saved.SavedObject`."""
        state: StateData = {}
        if are_changed(self.properties, self.node):
            state["properties"] = plain_properties(self.name, self.properties)
        if self.visible != self.node.visible:
            state["visible"] = self.visible
        state |= self._looks.get_state()
        if self._is_displaced:
            state["position"], state["rotation"] = tuple(self._local[0]), tuple(self._local[1])
        return state

    def set_state(self, state: SavedObject) -> None:
        """Restore a validated state; called for parents before their children, after all objects were reset."""
        if state.properties is not None:
            self.properties = plain_properties(self.name, state.properties)
        if state.visible is not None:
            self.visible = state.visible
        if self._looks.set_state(state):
            self._world.appearance_changed(self)
        if state.position is not None and state.rotation is not None:
            self._set_local((state.position, state.rotation))

    # -- identity --------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The name in the scene."""
        return self.node.name

    @property
    def is_dynamic(self) -> bool:
        """Whether the object is a dynamic body, or a link that a joint moves."""
        return self._world.slots[self.slot].frame.motion in (Motion.FREE, Motion.JOINT)

    @property
    def mass(self) -> float:
        """Mass, kg, of a robot from a file with all of its links; 0 for an object that is not dynamic."""
        if (bodies := self._world.whole.get(self.slot)) is not None:
            return sum(self._world.bodies.masses[body] for body in bodies)
        slot = self._world.slots[self.slot]
        return self._world.bodies.masses[slot.body] if self.is_dynamic and slot.body > 0 else 0.0

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
        """The object to which this object is attached, in the scene or later by `setParent`."""
        if self._leads:
            holder = self._world.attachments.holder(self.slot)
            if holder is not None:
                return self._world.object_of(holder.node)
        return self._world.object_of(self.node.parent) if self.node.parent is not None else None

    @property
    def children(self) -> ObjectList[GameObject]:
        """The objects that are attached to this object."""
        return ObjectList([self._world.object_of(child) for child in self.node.children])

    @property
    def childrenRecursive(self) -> ObjectList[GameObject]:  # noqa: N802
        """All objects below this object in the tree."""
        return ObjectList([self._world.object_of(node) for node in self.node.walk() if node is not self.node])

    def setParent(self, parent: Posed, compound: bool = True, ghost: bool = True) -> None:  # noqa: N802
        """Attach this object to another object at its present relative pose."""
        if self._leads:
            self._world.attachments.hold(self.slot, cast("GameObject", parent))

    def removeParent(self) -> None:  # noqa: N802
        """Undo `setParent`."""
        self._world.attachments.release(self.slot)

    # -- properties ------------------------------------------------------------------------

    def __getitem__(self, name: str) -> Value:
        return self.properties[name]

    def __setitem__(self, name: str, value: object) -> None:
        self.properties[name] = value

    def __delitem__(self, name: str) -> None:
        del self.properties[name]

    def __contains__(self, name: object) -> bool:
        return name in self.properties

    def __iter__(self) -> Iterator[str]:
        return iter(self.properties)

    def get(self, name: str, default: object = None) -> Value:
        """Return a property, or ``default``."""
        return self.properties.get(name, default)

    def getPropertyNames(self) -> list[str]:  # noqa: N802
        """Return the names of the properties."""
        return list(self.properties)

    # -- pose ------------------------------------------------------------------------------

    def world_pose(self) -> _Pose:
        """Return the position (3) and rotation (9, row-major) in the world, as plain floats."""
        world = self._world
        if self._stamp != world.stamp:
            position, rotation = world.positions[self.slot], world.rotations[self.slot]
            mounting = self.mounting
            self._pose = mounting.carried(position, rotation) if mounting.is_apart else (position, rotation)
            self._stamp = world.stamp
        return self._pose

    @property
    def stamp(self) -> int:
        """A value that changes whenever an object has moved."""
        return self._world.stamp

    def pose_of(self, _row: int) -> _Pose:
        """Return `world_pose`, for a pose that follows this object."""
        return self.world_pose()

    def local_pose(self) -> _Pose:
        """Position (3) and rotation (9) in the frame of the parent."""
        if not self._leads:
            return self._local
        parent = self.parent
        return self.world_pose() if parent is None else rigid.relative(*parent.world_pose(), *self.world_pose())

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose of the object in the world, with all attached objects; its velocity is unchanged.

        Raises:
            ValueError: a value is not finite or exceeds `morse.physics.poses.convert.POSITION`.
        """
        world = self._world
        position = floats3(position, POSITION)
        demand_rotation(rotation)
        if self._leads:
            world.bodies.place(self.slot, position, rotation)
            world.attachments.moved(self.slot)
            return
        assert self.node.parent is not None
        outer = world.object_of(self.node.parent).world_pose()
        self._set_local(rigid.relative(*outer, position, rotation))

    def set_local_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose of the object in the frame of its parent; see `set_pose`."""
        position = floats3(position, POSITION)
        demand_rotation(rotation)
        if not self._leads:
            self._set_local((position, rotation))
            return
        parent = self.parent
        pose = (position, rotation)
        self.set_pose(*(pose if parent is None else rigid.compose(*parent.world_pose(), *pose)))

    def _set_local(self, pose: _Pose) -> None:
        self._local = pose
        self._is_displaced = True
        self._world.displacements += 1
        self._follow()
        self._world.note_displaced(self)

    def _follow(self) -> None:
        """Update the poses of this object and of those below it in the rigid group."""
        if self._moved_along is None:
            self._moved_along = self._find_moved_along()
        everything, solid = self._moved_along
        for obj in everything:
            obj._forget_offset()
        for obj in solid:
            self._world.bodies.move_shapes(obj.node, obj.offset)

    def _find_moved_along(self) -> tuple[list[GameObject], list[GameObject]]:
        """Return this object and those below it in the rigid group, outer ones first; and those of them with shapes."""
        world, objects = self._world, [self]
        for obj in objects:
            below = (world.object_of(child) for child in obj.node.children)
            objects += [child for child in below if child.slot == self.slot]
        geoms = world.slots[self.slot].geoms
        return objects, [obj for obj in objects if obj.node in geoms]

    def _forget_offset(self) -> None:
        """Invalidate the pose in the rigid group; it is computed on demand, because most are never read."""
        vars(self).pop("mounting", None)
        self._stamp = -1

    def _carried_offset(self) -> _Pose:
        """Return the pose in the rigid group, from that of the parent."""
        assert self.node.parent is not None
        return rigid.compose(*self._world.object_of(self.node.parent).offset, *self._local)

    @property
    def offset(self) -> _Pose:
        """Position and rotation in the rigid group of the object."""
        return self.mounting.offset, self.mounting.turned

    # -- velocity and forces ---------------------------------------------------------------

    def velocity(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return the linear and angular velocity of its origin, in world axes."""
        linear, angular = self._world.bodies.velocity(self.slot)
        if self.mounting.is_apart:
            origin, here = self._world.positions[self.slot], self.world_pose()[0]
            arm = (here[0] - origin[0], here[1] - origin[1], here[2] - origin[2])
            x, y, z = rigid.cross(angular, arm)
            linear = (linear[0] + x, linear[1] + y, linear[2] + z)
        return linear, angular

    @property
    def twist_place(self) -> int | None:
        """See `morse.core.world.Body.twist_place`."""
        slot = self._world.slots[self.slot]
        is_free = slot.frame.motion is Motion.FREE and slot.dof >= 0 and not self.mounting.is_apart
        return slot.dof if is_free else None

    def set_velocity(self, linear: Sequence[float] | None, angular: Sequence[float] | None) -> None:
        """Set the velocity of its body in world axes; None keeps the present velocity."""
        self._world.bodies.set_velocity(
            self.slot,
            None if linear is None else floats3(linear, VELOCITY),
            None if angular is None else floats3(angular, ANGULAR_VELOCITY),
        )

    def drive(
        self, linear: Sequence[float], angular: Sequence[float], *, position: bool = False, ground: bool = False
    ) -> None:
        """See `morse.core.world.Body.drive`."""
        x, y, z = floats3(linear, VELOCITY)
        wx, wy, wz = floats3(angular, ANGULAR_VELOCITY)
        # there is no negative zero among the commands: equal commands give the same bits
        command = Command((x + 0.0, y + 0.0, z + 0.0), (wx + 0.0, wy + 0.0, wz + 0.0), position, ground)
        self._world.drives.command(self.slot, command)

    def halt(self) -> None:
        """Set the velocity to 0."""
        self._world.drives.cancel(self.slot)
        self.set_velocity(_ORIGIN, _ORIGIN)

    def wrench(self, force: Sequence[float], torque: Sequence[float], local: bool) -> None:
        """Apply a force (N) and a torque (N m) at the centre of mass during the next tick."""
        force, torque = floats3(force, FORCE), floats3(torque, TORQUE)
        if local:
            rotation = self.world_pose()[1]
            force, torque = rigid.turn(rotation, force), rigid.turn(rotation, torque)
        self._world.bodies.apply_wrench(self.slot, force, torque)

    def set_added_mass(self, mass: Sequence[float], inertia: Sequence[float]) -> None:
        """See `morse.core.world.Body.set_added_mass`."""
        self._world.bodies.set_added_mass(self.slot, mass, inertia)

    def pull(
        self, anchor: Sequence[float], target: Sequence[float], stiffness: float, damping: float, strongest: float
    ) -> None:
        """See `morse.core.world.Body.pull`."""
        point, _ = rigid.compose(*self.world_pose(), floats3(anchor, POSITION), rigid.IDENTITY)
        self._world.bodies.pull(self.slot, point, floats3(target, POSITION), stiffness, damping, strongest)

    def contact_forces(self) -> list[tuple[GameObject, tuple[float, float, float]]]:
        """See `morse.core.world.Body.contact_forces`."""
        return self._world.contact_moment([self]).forces(self)

    def joint_load(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """See `morse.core.world.Body.joint_load`."""
        return self._world.joint_moment([self]).load(self, self.world_pose()[0])

    def suspendDynamics(self, ghost: bool = False) -> None:  # noqa: N802
        """Keep the object at its pose, independent of the forces on it."""
        self._world.attachments.suspend(self.slot)

    def restoreDynamics(self) -> None:  # noqa: N802
        """Resume the physics of the object."""
        self._world.attachments.resume(self.slot)

    @property
    def isSuspendDynamics(self) -> bool:  # noqa: N802
        """Whether the physics of the object is suspended."""
        return self._world.attachments.is_suspended(self.slot)

    def disable_gravity(self) -> None:
        """Disable gravity for the object."""
        self._world.bodies.set_weightless(self.slot)

    def wheels(self) -> list[Wheel]:
        """The driven wheels of a wheeled robot."""
        world = self._world
        wheels = (world.slots[index].frame.node for index in world.wheels.get(self.slot, ()))
        return [Wheel(world, world.object_of(node), self) for node in wheels]

    def joints(self) -> JointHandle | None:
        """The joints of an armature, or None if the physics does not move them."""
        return JointHandle(self._world, self.node) if self.node in self._world.joints else None

    # -- distances and rays ----------------------------------------------------------------

    def getDistanceTo(self, other: Posed | Sequence[float]) -> float:  # noqa: N802
        """Return the distance between origins, m."""
        return math.dist(self.world_pose()[0], _point(other))

    def getVectTo(self, other: Posed | Sequence[float]) -> tuple[float, Vector, Vector]:  # noqa: N802
        """Return the distance (m) and the unit vector to an object or point, in world axes and in object axes."""
        position, rotation = self.world_pose()
        target = _point(other)
        delta = tuple(b - a for a, b in zip(position, target, strict=True))
        distance = math.sqrt(sum(d * d for d in delta))
        unit = tuple(d / distance for d in delta) if distance else _ORIGIN
        return distance, Vector(unit), Vector(rigid.turn_back(rotation, unit))

    def rayCast(  # noqa: N802
        self,
        objto: Posed | Sequence[float],
        objfrom: Posed | Sequence[float] | None = None,
        dist: float = 0.0,
        prop: str = "",
        face: int = 0,
        xray: int = 0,
        poly: int = 0,
    ) -> tuple[GameObject | None, Vector | None, Vector | None]:
        """See `morse.core.world.Body.rayCast`."""
        start = self.world_pose()[0] if objfrom is None else _point(objfrom)
        return self._world.cast(start, _point(objto), dist, prop, bool(xray), self)

    def rayCastTo(  # noqa: N802
        self, other: Posed | Sequence[float], dist: float = 0.0, prop: str = ""
    ) -> GameObject | None:
        """Return the first object on the line to a point, or None."""
        return self.rayCast(other, None, dist, prop)[0]

    def setVisible(self, visible: bool, recursive: bool = False) -> None:  # noqa: N802
        """Show or hide the object."""
        self.visible = bool(visible)
        self._world.appearance_changed(self)
        if recursive:
            for child in self.childrenRecursive:
                child.setVisible(visible)


GameObject.mounting = _OnDemand()  # type: ignore[assignment]


def _flat(matrix: Matrix) -> tuple[float, ...]:
    return tuple(value for row in matrix for value in row)


def _point(place: object) -> tuple[float, float, float]:
    if isinstance(place, GameObject):
        x, y, z = place.world_pose()[0]
        return x, y, z
    return floats3(place, POINT)  # type: ignore[arg-type] # which refuses what is no point
