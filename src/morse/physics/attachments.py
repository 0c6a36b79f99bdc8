"""Objects that are held: hanging on another one, or kept where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.physics import rigid
from morse.physics.kinematics import sync

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.physics.bodies import Bodies
    from morse.physics.engine_state import EngineState
    from morse.physics.posed import Posed
    from morse.physics.saved import SavedAttachments

_Pose = tuple["Sequence[float]", "Sequence[float]"]


class Attachments:
    """Slots that go along with an object, and slots whose dynamics are suspended.

    A held body is put to its place before and after every tick. A weld would lag behind by
    several millimetres; the grip of the original had no lag at all.
    """

    def __init__(self, state: EngineState, bodies: Bodies) -> None:
        self._state = state
        self._bodies = bodies
        self._held: dict[int, tuple[Posed, _Pose]] = {}
        self._suspended: dict[int, _Pose] = {}

    def reset(self) -> None:
        """Let everything go; the model is as it was compiled."""
        self._held.clear()
        self._suspended.clear()

    def get_state(self) -> dict[str, Any]:
        """See `morse.physics.saved.SavedAttachments`."""
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
                for index, (position, rotation) in self._suspended.items()
            ],
        }

    def set_state(self, state: SavedAttachments, objects: Mapping[str, Posed]) -> None:
        """Take over a state that was checked; the arrays of the model are set elsewhere.

        Args:
            objects: every object by name.
        """
        self.reset()
        named = self._state.named
        for entry in state.held:
            self._held[named[entry.slot]] = (objects[entry.holder], (entry.position, entry.rotation))
        for kept in state.suspended:
            self._suspended[named[kept.slot]] = (kept.position, kept.rotation)

    def hold(self, index: int, holder: Posed) -> None:
        """Let a slot hang on an object, where it is now; it collides with nothing meanwhile."""
        state = self._state
        offset = rigid.relative(*holder.world_pose(), state.positions[index], state.rotations[index])
        self._held[index] = (holder, offset)
        self._bodies.set_collision(state.slots[index].frame.solid, False)

    def holder(self, index: int) -> Posed | None:
        """What a slot hangs on."""
        entry = self._held.get(index)
        return entry[0] if entry else None

    def release(self, index: int) -> None:
        """Let a slot go."""
        if self._held.pop(index, None) is not None:
            solid = [node for node in self._state.slots[index].frame.solid if node.body.collides]
            self._bodies.set_collision(solid, True)

    def suspend(self, index: int) -> None:
        """Keep a slot at its pose, independent of the forces on it."""
        if index not in self._suspended:
            state = self._state
            self._suspended[index] = (state.positions[index], state.rotations[index])

    def resume(self, index: int) -> None:
        """Let a slot obey the physics again."""
        self._suspended.pop(index, None)

    def is_suspended(self, index: int) -> bool:
        """Whether a slot is kept where it is."""
        return index in self._suspended

    def moved(self, index: int) -> None:
        """A suspended slot was put somewhere else: keep it there."""
        if index in self._suspended:
            state = self._state
            self._suspended[index] = (state.positions[index], state.rotations[index])

    def before_step(self) -> None:
        """The tick begins."""
        if self._held or self._suspended:
            self._place()

    def after_step(self) -> None:
        """The tick ends; the poses of the holders are those of its beginning plus their motion."""
        if not self._held and not self._suspended:
            return
        sync(self._state)
        self._place()

    def _place(self) -> None:
        bodies = self._bodies
        for index, (position, rotation) in self._suspended.items():
            bodies.place(index, position, rotation)
            bodies.set_velocity(index, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for index, (holder, (offset, turned)) in self._held.items():
            bodies.place(index, *rigid.compose(*holder.world_pose(), offset, turned))
            bodies.set_velocity(index, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
