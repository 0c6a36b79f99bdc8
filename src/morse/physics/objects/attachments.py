"""Objects that are attached to another object, whose physics is suspended, or whose motion is locked for some axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.model.layout import Motion
from morse.physics.poses import rigid
from morse.physics.poses.kinematics import sync
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.values import StateData
    from morse.physics.bodies import Bodies
    from morse.physics.model.layout import Frame
    from morse.physics.objects.object_world import Posed
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedAttachments
    from morse.physics.tick import Tick


_Pose = tuple["Sequence[float]", "Sequence[float]"]
_AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
#: inertia, kg or kg m^2, of a suspended body with links: forces accelerate it by next to nothing
_IMMOVABLE = 1e12


class Attachments:
    """Slots that are attached to an object, and slots whose dynamics are suspended.

    The pose of a held body is set before and after every tick. A weld constraint would lag behind by several
    millimetres; the grip of MORSE 1.4 did not lag.

    A suspended body with links does not move during the steps of the engine either. If it fell and were put back, or if
    the ground pushed it out, its links would be accelerated relative to it, and sensors would show forces.
    """

    def __init__(self, state: EngineState, bodies: Bodies, tick: Tick) -> None:
        self._state = state
        self._tick = tick
        self._bodies = bodies
        self._held: dict[int, tuple[Posed, _Pose]] = {}
        #: position, rotation and quaternion
        self._suspended: dict[int, tuple[Sequence[float], Sequence[float], Sequence[float]]] = {}
        #: first degree of freedom of each body that does not move in this tick, and what the model has there
        self._fixed: dict[int, NDArray[np.float64]] = {}

    def reset(self) -> None:
        """Release all slots, after the model was reset to its compiled values."""
        self._held.clear()
        self._suspended.clear()
        self._tick.rearrange()

    def get_state(self) -> StateData:
        """See `morse.physics.state.saved.SavedAttachments`."""
        names = self._state.names
        return {
            "held": [
                {
                    "slot": names[index],
                    "holder": holder.node.name,
                    "position": tuple(offset),
                    "rotation": tuple(turned),
                }
                for index, (holder, (offset, turned)) in self._held.items()
            ],
            "suspended": [
                {"slot": names[index], "position": tuple(position), "rotation": tuple(rotation)}
                for index, (position, rotation, _) in self._suspended.items()
            ],
        }

    def set_state(self, state: SavedAttachments, objects: Mapping[str, Posed]) -> None:
        """Restore a validated state; the arrays of the model are set elsewhere.

        Args:
            objects: all objects by name.
        """
        self.reset()
        slots_by_name = self._state.named
        for entry in state.held:
            self._held[slots_by_name[entry.slot]] = (objects[entry.holder], (entry.position, entry.rotation))
        for kept in state.suspended:
            self._suspended[slots_by_name[kept.slot]] = _kept(kept.position, kept.rotation)
        self._tick.rearrange()

    def hold(self, index: int, holder: Posed) -> None:
        """Attach a slot to an object at its present relative pose; it does not collide while it is attached."""
        state = self._state
        offset = rigid.relative(*holder.world_pose(), state.positions[index], state.rotations[index])
        self._held[index] = (holder, offset)
        self._tick.rearrange()
        self._bodies.set_collision(state.slots[index].frame.solid, False)

    def holder(self, index: int) -> Posed | None:
        """Return the object to which a slot is attached, or None."""
        entry = self._held.get(index)
        return entry[0] if entry else None

    def release(self, index: int) -> None:
        """Detach a slot."""
        if self._held.pop(index, None) is not None:
            solid = [node for node in self._state.slots[index].frame.solid if node.body.collides]
            self._bodies.set_collision(solid, True)
            self._tick.rearrange()

    def suspend(self, index: int) -> None:
        """Keep a slot at its present pose, independent of the forces on it."""
        if index not in self._suspended:
            state = self._state
            self._suspended[index] = _kept(state.positions[index], state.rotations[index])
            self._tick.rearrange()

    def resume(self, index: int) -> None:
        """Resume the dynamics of a slot."""
        if self._suspended.pop(index, None) is not None:
            self._tick.rearrange()

    def is_suspended(self, index: int) -> bool:
        """Whether the dynamics of a slot are suspended."""
        return index in self._suspended

    @property
    def has_work(self) -> bool:
        """Whether a slot is attached or suspended."""
        return bool(self._held or self._suspended)

    def moved(self, index: int) -> None:
        """Update the pose of a suspended slot that was moved."""
        if index in self._suspended:
            state = self._state
            self._suspended[index] = (state.positions[index], state.rotations[index], state.quaternions[index])

    def before_step(self) -> None:
        """Called at the beginning of a tick."""
        bodies, state = self._bodies, self._state
        # those of a tick that has failed
        self._let_move()
        for index in self._suspended:
            slot = state.slots[index]
            if slot.frame.motion is Motion.FREE and slot.dof >= 0 and state.links.get(index):
                inertias = state.model.dof_armature[slot.dof : slot.dof + 6]
                self._fixed[slot.dof] = inertias.copy()
                inertias[:] = _IMMOVABLE
            # the object is already at its pose, which was set at the end of the last tick or by `moved`
            bodies.set_velocity(index, *_AT_REST)
        if self._held:
            self._place_held()

    def after_step(self) -> None:
        """Called at the end of a tick, when the holders have moved; the poses of all slots are computed afterwards."""
        self._let_move()
        bodies = self._bodies
        if not self._held:
            for index, (position, rotation, offset_rotation) in self._suspended.items():
                bodies.put_back(index, position, rotation, offset_rotation)
            return
        sync(self._state)
        for index, (position, rotation, _) in self._suspended.items():
            bodies.place(index, position, rotation)
            bodies.set_velocity(index, *_AT_REST)
        self._place_held()

    def _let_move(self) -> None:
        for dof, inertias in self._fixed.items():
            self._state.model.dof_armature[dof : dof + 6] = inertias
        self._fixed.clear()

    def _place_held(self) -> None:
        bodies = self._bodies
        for index, (holder, (offset, rotation)) in self._held.items():
            bodies.place(index, *rigid.compose(*holder.world_pose(), offset, rotation))
            bodies.set_velocity(index, *_AT_REST)


def _kept(
    position: Sequence[float], rotation: Sequence[float]
) -> tuple[Sequence[float], Sequence[float], Sequence[float]]:
    return position, rotation, rigid.quaternion(rotation)


class Locks:
    """Keeps the locked coordinates of free bodies constant during every tick.

    Velocities along locked axes are set to 0 before the steps of the engine, and motion along these axes is undone
    afterwards. A body can still be moved by explicit calls. Rotations are locked for all axes together, because the
    axes of a body rotate with it.

    Ground robots of the type ``DYNAMIC`` do not roll or pitch, as in 1.4: the engine does not rotate bodies of this
    type, and commands only turn ground robots about their vertical axis.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        positions: list[int] = []
        velocities: list[int] = []
        level: list[int] = []
        for slot in state.slots:
            if slot.frame.motion is not Motion.FREE or slot.qpos < 0:
                continue
            body = slot.frame.node.body
            for axis in range(3):
                if body.lock_location[axis]:
                    positions.append(slot.qpos + axis)
                    velocities.append(slot.dof + axis)
            if any(body.lock_rotation):
                positions += range(slot.qpos + 3, slot.qpos + 7)
                velocities += range(slot.dof + 3, slot.dof + 6)
            elif _stays_level(slot.frame):
                level += range(slot.dof + 3, slot.dof + 5)
        self._positions = np.array(positions, dtype=np.intp)
        self._velocities = np.array(velocities, dtype=np.intp)
        self._level = np.array(level, dtype=np.intp)
        self._held = np.zeros(len(positions))

    @property
    def has_work(self) -> bool:
        """Whether a coordinate is locked."""
        return bool(len(self._positions) or len(self._level))

    def before_step(self) -> None:
        """Called at the beginning of a tick, after the commanded velocities are set."""
        if len(self._level):
            self._state.data.qvel[self._level] = 0.0
        if len(self._positions):
            self._state.data.qvel[self._velocities] = 0.0
            self._held = self._state.data.qpos[self._positions]

    def after_step(self) -> None:
        """Called at the end of a tick."""
        if len(self._level):
            self._state.data.qvel[self._level] = 0.0
        if len(self._positions):
            self._state.data.qpos[self._positions] = self._held
            self._state.data.qvel[self._velocities] = 0.0


def _stays_level(frame: Frame) -> bool:
    node = frame.node
    return (
        frame.robot is not None and node.body.type is PhysicsType.DYNAMIC and bool(node.properties.get("GroundRobot"))
    )
