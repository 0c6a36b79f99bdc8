"""Objects of a body that joints move, all in one call."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.linkage import FIXED, PRISMATIC, REVOLUTE, LinkageArrays, linkage
from morse.physics.model.layout import Motion
from morse.physics.objects.gameobject import GameObject
from morse.physics.poses import rigid
from morse.physics.poses.rigid import Mounting
from morse.scene import JointKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import mujoco

    from morse.physics.objects.object_world import ObjectWorld
    from morse.scene import Bone

_KINDS = {JointKind.FIXED: FIXED, JointKind.REVOLUTE: REVOLUTE, JointKind.PRISMATIC: PRISMATIC}
_Pose = tuple["Sequence[float]", "Sequence[float]"]


class LedObject(GameObject):
    """An object that a linkage moves: its poses are computed when they are read.

    It is a separate class, so that the poses of all other objects are read without a check.
    """

    _linkage: Linkage

    @staticmethod
    def lead(obj: GameObject, linkage: Linkage) -> None:
        """Let a linkage move an object from now on."""
        _ = obj.mounting  # computes the pose, if it was invalidated
        obj.__class__ = LedObject
        vars(obj)["_linkage"] = linkage

    @staticmethod
    def leave(obj: GameObject) -> None:
        """Let an object keep its present poses."""
        if isinstance(obj, LedObject):
            obj._linkage.settle()
            obj.__class__ = GameObject  # type: ignore[assignment]
            del vars(obj)["_linkage"]

    @property
    def _local(self) -> _Pose:
        self._linkage.settle()
        pose: _Pose = vars(self)["_local"]
        return pose

    @_local.setter
    def _local(self, pose: _Pose) -> None:
        self._change("_local", pose)

    @property
    def mounting(self) -> Mounting:
        """Pose of the object in its rigid group."""
        self._linkage.settle()
        mounting: Mounting = vars(self)["mounting"]
        return mounting

    @mounting.setter
    def mounting(self, mounting: Mounting) -> None:
        self._change("mounting", mounting)

    def _forget_offset(self) -> None:
        self.mounting = Mounting.of(self._carried_offset())
        self._stamp = -1

    def _change(self, name: str, value: object) -> None:
        """Notify the linkage that the object was moved in another way, so that it reads the pose again."""
        self._linkage.settle()
        self._linkage.is_outdated = True
        vars(self)[name] = value


#: object, index of its bone, and its pose in the frame of the bone
Hanging = tuple["GameObject", int, "Sequence[float]", "Sequence[float]"]


class Linkage:
    """The bones of an armature and the objects attached to them.

    Moving each object separately takes ten times as long. The poses of the objects are converted to Python objects only
    when they are read, see `LedObject`.

    Args:
        world: the world.
        armature: the object above them.
        bones: parents first, m; those without a parent are in the frame of the outer object of the attached objects.
        hanging: objects attached to bones, outer objects first.
    """

    is_apparatus = True

    def __init__(
        self, world: ObjectWorld, armature: GameObject, bones: Sequence[Bone], hanging: Sequence[Hanging]
    ) -> None:
        self._world = world
        self._armature = armature
        self._bones = bones
        self._hanging = list(hanging)
        self._model: mujoco.MjModel | None = None
        self._entries: list[GameObject] = []
        self._is_whole = False
        self._is_stale = False
        #: whether an object of the linkage was moved in another way
        self.is_outdated = True
        self._turning = [i for i, bone in enumerate(bones) if bone.kind is not JointKind.FIXED]

    # -- moving ----------------------------------------------------------------------------

    def move(self, values: Sequence[float]) -> None:
        """Move to joint values, rad or m: one for each bone that is not fixed, in the order of the bones."""
        if not self._hanging:
            return
        if self._model is not self._world.model or not self._leads():
            self._build()
        if not self._is_whole:
            self._move_each(values)
            return
        if self.is_outdated:
            self._refresh()
        self._turn(values)
        world, slot = self._world, self._armature.slot
        self._arrays.up[:] = world.rotations[slot][6:9]
        reach, lowest = self._work.move()
        self._is_stale = True
        if self._geoms:
            world.bodies.shapes_have_moved(slot, self._geoms, self._nodes, reach, lowest)
        world.displacements += 1
        world.stamp += 1

    def _leads(self) -> bool:
        """Whether the objects have not been assigned to another linkage."""
        return not self._entries or vars(self._entries[0]).get("_linkage") is self

    def _turn(self, values: Sequence[float]) -> None:
        """Copy the values of the joints."""
        numbers, cos, sin = self._numbers, math.cos, math.sin
        for (first, slides), value in zip(self._joints, values, strict=True):
            if slides:
                numbers[first] = value
            else:
                numbers[first], numbers[first + 1] = cos(value), sin(value)
        # copying one list is faster than copying single numbers
        self._moves[:] = numbers

    def settle(self) -> None:
        """Set the present poses of the objects."""
        if not self._is_stale:
            return
        self._is_stale = False
        arrays = self._arrays
        rows = zip(self._entries, arrays.hooks.tolist(), arrays.locals.tolist(), arrays.poses.tolist(), strict=True)
        for obj, hook, local, pose in rows:
            own = vars(obj)
            if hook >= 0:
                own["_local"] = tuple(local[:3]), tuple(local[3:])
            own["mounting"] = Mounting.of((tuple(pose[:3]), tuple(pose[3:])))

    def _move_each(self, values: Sequence[float]) -> None:
        """Move the objects one by one: some belong to other bodies, or to other linkages."""
        self._turn(values)
        self._work.move()
        frames = self._arrays.frames.tolist()
        for obj, bone, offset, rotation in self._hanging:
            p, r = frames[bone][:3], frames[bone][3:]
            obj.set_local_pose(*rigid.compose(p, r, offset, rotation))

    # -- building --------------------------------------------------------------------------

    def _build(self) -> None:
        """Find the moving objects and shapes in a newly compiled world."""
        world, slot = self._world, self._armature.slot
        self._model = world.model
        bones = self._bones
        entries = list(self._walk())
        objects = [obj for obj, _, _ in entries]
        for obj in (*self._entries, *objects):
            if isinstance(obj, LedObject) and obj._linkage._armature is self._armature:
                LedObject.leave(obj)
        self._is_whole = world.slots[slot].frame.motion is not Motion.HINGE and all(
            obj.slot == slot and not isinstance(obj, LedObject) and (outer >= 0 or obj.parent is objects[0].parent)
            for obj, outer, _ in entries
        )
        if not self._is_whole:
            entries, objects = [], []
        geoms = world.slots[slot].geoms
        shapes = [
            (geom, owner, world.bodies.shape_pose(geom, shape))
            for owner, obj in enumerate(objects)
            for geom, shape in zip(geoms.get(obj.node, ()), obj.node.shapes or (), strict=obj.node in geoms)
        ]
        all_geoms = [*(geom for geoms_of_part in geoms.values() for geom in geoms_of_part), *world.slots[slot].feet]
        model = world.model
        self._arrays = LinkageArrays(
            parents=np.array([bone.parent for bone in bones], dtype=np.int64),
            kinds=np.array([_KINDS[bone.kind] for bone in bones], dtype=np.int64),
            axes=np.array([bone.axis for bone in bones], dtype=np.int64),
            places=_rows([bone.position for bone in bones], 3),
            turns=_rows([bone.rotation for bone in bones], 9),
            outers=np.array([outer for _, outer, _ in entries], dtype=np.int64),
            hooks=np.array([-1 if hung is None else hung[1] for _, _, hung in entries], dtype=np.int64),
            held=_rows([[0.0] * 12 if hung is None else [*hung[2], *hung[3]] for _, _, hung in entries], 12),
            geoms=np.array([geom for geom, _, _ in shapes], dtype=np.int64),
            owners=np.array([owner for _, owner, _ in shapes], dtype=np.int64),
            mounts=_rows([[*position, *rotation] for _, _, (position, rotation) in shapes], 12),
            geom_positions=model.geom_pos,
            geom_quaternions=model.geom_quat,
            geom_radii=model.geom_rbound,
            geom_boxes=model.geom_aabb,
            all_geoms=np.array(all_geoms, dtype=np.int64),
        )
        self._moves = self._arrays.moves.reshape(-1)
        self._numbers = self._moves.tolist()
        self._joints = [(2 * i, bones[i].kind is JointKind.PRISMATIC) for i in self._turning]
        self._geoms = [geom for geom, _, _ in shapes]
        self._nodes = [obj.node for obj in objects if obj.node in geoms]
        self._work = linkage(self._arrays)
        self._entries, self._is_stale, self.is_outdated = objects, False, True
        for obj in objects:
            LedObject.lead(obj, self)

    def _walk(self) -> Iterator[tuple[GameObject, int, Hanging | None]]:
        """All moving objects, outer ones first: object, index of the outer object, its attachment to a bone."""
        hangs = {id(hung[0]): hung for hung in self._hanging}
        index: dict[int, int] = {}
        for obj, *_ in self._hanging:
            if id(obj) in index:
                continue
            queue = [obj]
            while queue:
                inner = queue.pop(0)
                parent = inner.parent
                yield inner, index.get(id(parent), -1), hangs.get(id(inner))
                index[id(inner)] = len(index)
                queue += inner.children

    def _refresh(self) -> None:
        """Read the poses of objects that were moved in another way."""
        arrays = self._arrays
        self.settle()
        for row, (obj, hook) in enumerate(zip(self._entries, arrays.hooks.tolist(), strict=True)):
            if hook < 0:
                position, rotation = vars(obj)["_local"]
                arrays.held[row] = [*position, *rotation]
            else:
                vars(obj)["_is_displaced"] = True
                self._world.note_displaced(obj)
        first = self._entries[0].parent
        assert first is not None
        position, rotation = first.offset
        arrays.base[:] = [*position, *rotation]
        self.is_outdated = False


def _rows(rows: Sequence[Sequence[float]], width: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array(rows, dtype=np.float64).reshape(-1, width)
