"""Transfers the state of a world to the recompiled model of a changed scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.engine_functions import WIDE_AWAKE, boxes_of, trees_near
from morse.physics.model import motors
from morse.physics.model.layout import Motion
from morse.physics.state import engine_values, saved

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from numpy.typing import NDArray

    from morse.physics.model.layout import Slot
    from morse.physics.state.engine_state import EngineState

_OF_BODIES = ("body_pos", "body_quat")
_OF_CONTACTS = ("geom_condim", "geom_priority")
_OF_SURFACES = ("geom_pos", "geom_quat", *_OF_CONTACTS)


class Transfer:
    """The part of the state that is kept when the scene of a world changes.

    Args:
        old: the engine before the change.
        new: the engine after the change, in its compiled state.
        floors: bits of the floors before the change to bits after the change.
        renewed: names of objects that start again as in the scene.
    """

    def __init__(
        self, old: EngineState, new: EngineState, floors: dict[int, int], renewed: Collection[str] = ()
    ) -> None:
        self._old, self._new = old, new
        self._floors, self._renewed = floors, renewed
        names = [name for name in new.names if name in old.named and name not in renewed]
        pairs = [(old.slots[old.named[name]], new.slots[new.named[name]]) for name in names]
        #: pairs of old and new slots that move in the same way; and those that also have the same shapes
        self._kept = [(a, b) for a, b in pairs if a.frame.motion is b.frame.motion]
        self._same = [(a, b) for a, b in self._kept if _shapes(a) == _shapes(b) and len(a.feet) == len(b.feet)]
        self._kept_names = {b.frame.node.name for _, b in self._kept}
        self._same_names = {b.frame.node.name for _, b in self._same}

    def state(self, before: saved.SavedWorld, objects: Iterable[str]) -> saved.SavedWorld:
        """Return the state of the new world.

        Args:
            before: state of the old world, in which objects attached to removed objects are already detached.
            objects: names of the unchanged objects.
        """
        names, same, staying = self._kept_names, self._same_names, set(objects)
        gliding = self._gliding(before.gliding)
        return saved.SavedWorld(
            version=saved.VERSION,
            slots=self._new.names,
            engine=self._engine(before),
            placed=[entry for entry in before.placed if entry.slot in names],
            stale=[entry for entry in before.stale if entry.slot in names],
            loose=[name for name in before.loose if name in names],
            kinematic=[entry for entry in before.kinematic if entry.slot in names],
            objects={
                name: _as_far_as(entry, name in staying)
                for name, entry in before.objects.items()
                if name not in self._renewed
            },
            drives=saved.SavedDrives(
                [entry for entry in before.drives.commands if entry.slot in names],
                [name for name in before.drives.sliding if name in same],
            ),
            attachments=saved.SavedAttachments(
                [entry for entry in before.attachments.held if entry.slot in names],
                [entry for entry in before.attachments.suspended if entry.slot in names],
            ),
            gliding=gliding,
        )

    def _gliding(self, before: saved.SavedGliding) -> saved.SavedGliding:
        result = saved.SavedGliding(**{name: getattr(before, name) for name in before.__struct_fields__})
        result.stands = [stand for stand in before.stands if stand.slot in self._same_names]
        result.glides = [
            saved.SavedGlide(
                glide.slot, self._floors[glide.floor], glide.up, glide.look, glide.speed, glide.since, glide.margin
            )
            for glide in before.glides
            if glide.slot in self._same_names and glide.floor in self._floors
        ]
        return result

    # -- the engine ------------------------------------------------------------------------

    def _engine(self, before: saved.SavedWorld) -> saved.SavedEngine:
        old, new = self._old, self._new
        gliding = {glide.slot for glide in before.gliding.glides}
        model = {name: getattr(new.model, name).copy() for name in engine_values.CHANGED_WHILE_RUNNING}
        held_slots = {entry.slot for entry in before.attachments.held}
        loose = set(before.loose)
        for a, b in self._kept:
            name = b.frame.node.name
            self._carry_motion(a, b)
            self._carry_controls(a, b, model)
            if b.body <= 0:
                continue
            if name in loose:
                for array in _OF_BODIES:
                    model[array][b.body] = getattr(old.model, array)[a.body]
            if name not in gliding and b.frame.motion is Motion.FREE:
                model["body_gravcomp"][b.body] = old.model.body_gravcomp[a.body]
            if name in held_slots:
                for geom in _geoms(b):
                    model["geom_contype"][geom] = model["geom_conaffinity"][geom] = 0
        commands = {slot.key: old.data.ctrl[slot.actuator] for slot in old.file_motors}
        for slot in new.file_motors:
            new.data.ctrl[slot.actuator] = commands.get(slot.key, slot.start)
        new.data.time = old.data.time
        for a, b in self._same:
            # static shapes have the poses of the new scene, unless they were moved by explicit calls
            is_placed = b.body == 0 and b.frame.node.name not in loose
            self._carry_shapes(a, b, model, _OF_CONTACTS if is_placed else _OF_SURFACES)
        numbers = engine_values.integration(new)
        return saved.SavedEngine(numbers, self._asleep(), model, self._contacts(before), before.engine.forces, True)

    def _carry_motion(self, a: Slot, b: Slot) -> None:
        """Transfer the positions, velocities and forces of a slot."""
        old, new = self._old.data, self._new.data
        if b.qpos >= 0 and a.numbers == b.numbers:
            count, dofs = b.numbers
            new.qpos[b.qpos : b.qpos + count] = old.qpos[a.qpos : a.qpos + count]
            for name in ("qvel", "qacc_warmstart", "qfrc_applied"):
                getattr(new, name)[b.dof : b.dof + dofs] = getattr(old, name)[a.dof : a.dof + dofs]
        if b.mocap >= 0:
            new.mocap_pos[b.mocap], new.mocap_quat[b.mocap] = old.mocap_pos[a.mocap], old.mocap_quat[a.mocap]
        if b.actuator >= 0:
            new.ctrl[b.actuator] = old.ctrl[a.actuator]
        before = {joint.name: joint for joint in a.joints}
        for joint in b.joints:
            if joint.actuator >= 0 and joint.name in before and before[joint.name].actuator >= 0:
                new.ctrl[joint.actuator] = old.ctrl[before[joint.name].actuator]
        if b.body >= 0:
            new.xfrc_applied[b.body] = old.xfrc_applied[a.body]

    def _carry_controls(self, a: Slot, b: Slot, model: Mapping[str, NDArray[np.float64]]) -> None:
        """Transfer the control modes of the motors of a slot."""
        before = {joint.name: joint for joint in a.joints if joint.motor is not None}
        for joint in b.joints:
            if joint.motor is None or joint.name not in before:
                continue
            control = motors.control_of(self._old.model.actuator_biasprm[before[joint.name].actuator])
            motors.write(model, joint.actuator, joint.dof, joint.motor.setting(control))

    def _carry_shapes(self, a: Slot, b: Slot, model: dict[str, NDArray[np.generic]], names: Iterable[str]) -> None:
        """Transfer changes of the shapes of a slot by drives and explicit calls."""
        old = self._old.model
        for one, other in zip(_geoms(a), _geoms(b), strict=True):
            for name in names:
                model[name][other] = getattr(old, name)[one]
            if not old.geom_contype[one]:
                model["geom_contype"][other] = model["geom_conaffinity"][other] = 0
            elif not model["geom_contype"][other]:
                model["geom_contype"][other] = old.geom_contype[one]
                model["geom_conaffinity"][other] = old.geom_conaffinity[one]
        if b.dof >= 0 and a.numbers == b.numbers:
            dofs = b.numbers[1]
            model["dof_damping"][b.dof : b.dof + dofs] = old.dof_damping[a.dof : a.dof + dofs]

    def _contacts(self, before: saved.SavedWorld) -> NDArray[np.int32]:
        number = {one: other for a, b in self._same for one, other in zip(_geoms(a), _geoms(b), strict=True)}
        old, new = self._old.planes, self._new.planes
        number |= {plane: new[number[box]] for box, plane in old.items() if number.get(box) in new}
        pairs = [(number[a], number[b]) for a, b in before.engine.contacts.tolist() if a in number and b in number]
        return np.array(pairs, dtype=np.int32).reshape(-1, 2)

    # -- sleep -----------------------------------------------------------------------------

    def _asleep(self) -> NDArray[np.int32]:
        """Return the sleep state: bodies keep sleeping, unless a body near them was added, removed or changed."""
        old, new = self._old, self._new
        woken = self._disturbed_trees()
        tree = {
            int(old.model.body_treeid[a.body]): int(new.model.body_treeid[b.body])
            for a, b in self._same
            if b.qpos >= 0 and b.frame.motion is Motion.FREE
        }
        before = old.data.tree_asleep.tolist()
        result = np.full(new.model.ntree, WIDE_AWAKE, dtype=np.int32)
        for index, other in tree.items():
            if before[index] < 0:
                result[other] = before[index]
                continue
            circle, member = [index], before[index]
            while member != index:
                circle.append(member)
                member = before[member]
            if all(member in tree and member not in woken for member in circle):
                result[other] = tree[before[index]]
        return result

    def _disturbed_trees(self) -> set[int]:
        """Return the trees of the old engine near shapes that are added, removed or changed."""
        old, new = self._old, self._new
        # the boxes of planes stand for them
        stays_old = {geom for a, _ in self._same for geom in _geoms(a)} | set(old.planes.values())
        stays_new = {geom for _, b in self._same for geom in _geoms(b)} | set(new.planes.values())
        going = boxes_of(old, [geom for geom in range(old.model.ngeom) if geom not in stays_old])
        mujoco.mj_kinematics(new.model, new.data)
        coming = boxes_of(new, [geom for geom in range(new.model.ngeom) if geom not in stays_new])
        return trees_near(old, np.concatenate([going, coming]))


def _geoms(slot: Slot) -> list[int]:
    return [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]


def _shapes(slot: Slot) -> list[tuple[object, int]]:
    """Return the nodes of a slot with the numbers of their geoms, and its parent."""
    parent = slot.frame.parent
    outer: list[tuple[object, int]] = [] if parent is None else [(parent.node, -1)]
    return outer + [(node, len(geoms)) for node, geoms in slot.geoms.items()]


def _as_far_as(entry: saved.SavedObject, stays: bool) -> saved.SavedObject:
    """Return the state of an object that is kept; an object whose node was replaced gets the pose of the new node."""
    return (
        entry if stays else saved.SavedObject(entry.properties, entry.visible, entry.color, entry.texture, entry.lamp)
    )
