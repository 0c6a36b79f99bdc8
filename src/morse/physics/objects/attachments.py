"""Objects that are attached to another object or whose physics is suspended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics.poses import rigid
from morse.physics.poses.kinematics import sync

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.values import StateData
    from morse.physics.bodies import Bodies
    from morse.physics.objects.posed import Posed
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedAttachments
    from morse.physics.tick import Tick

_Pose = tuple["Sequence[float]", "Sequence[float]"]
_AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Attachments:
    """Slots that are attached to an object, and slots whose dynamics are suspended.

    The pose of a held body is set before and after every tick. A weld constraint would lag behind by several
    millimetres; the grip of MORSE 1.4 did not lag.
    """

    def __init__(self, state: EngineState, bodies: Bodies, tick: Tick) -> None:
        self._state = state
        self._tick = tick
        self._bodies = bodies
        self._held: dict[int, tuple[Posed, _Pose]] = {}
        #: position, rotation and quaternion
        self._suspended: dict[int, tuple[Sequence[float], Sequence[float], Sequence[float]]] = {}

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
        bodies = self._bodies
        for index in self._suspended:
            # the object is already at its pose, which was set at the end of the last tick or by `moved`
            bodies.set_velocity(index, *_AT_REST)
        if self._held:
            self._place_held()

    def after_step(self) -> None:
        """Called at the end of a tick, when the holders have moved; the poses of all slots are computed afterwards."""
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

    def _place_held(self) -> None:
        bodies = self._bodies
        for index, (holder, (offset, rotation)) in self._held.items():
            bodies.place(index, *rigid.compose(*holder.world_pose(), offset, rotation))
            bodies.set_velocity(index, *_AT_REST)


def _kept(
    position: Sequence[float], rotation: Sequence[float]
) -> tuple[Sequence[float], Sequence[float], Sequence[float]]:
    return position, rotation, rigid.quaternion(rotation)
