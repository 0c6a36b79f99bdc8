"""Objects that are held: hanging on another one, or kept where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.gameobject import GameObject
    from morse.physics.world import World

_Pose = tuple["Sequence[float]", "Sequence[float]"]


class Attachments:
    """Slots that go along with an object, and slots whose dynamics are suspended.

    A held body is put to its place before and after every tick. A weld would lag behind by
    several millimetres; the grip of the original had no lag at all.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._held: dict[int, tuple[GameObject, _Pose]] = {}
        self._suspended: dict[int, _Pose] = {}

    def reset(self) -> None:
        """Let everything go; the model is as it was compiled."""
        self._held.clear()
        self._suspended.clear()

    def hold(self, index: int, holder: GameObject) -> None:
        """Let a slot hang on an object, where it is now; it collides with nothing meanwhile."""
        world = self._world
        offset = rigid.relative(*holder.world_pose(), world.positions[index], world.rotations[index])
        self._held[index] = (holder, offset)
        world.set_collision(world.slots[index].frame.solid, False)

    def holder(self, index: int) -> GameObject | None:
        """What a slot hangs on."""
        entry = self._held.get(index)
        return entry[0] if entry else None

    def release(self, index: int) -> None:
        """Let a slot go."""
        if self._held.pop(index, None) is not None:
            world = self._world
            solid = [node for node in world.slots[index].frame.solid if node.body.collides]
            world.set_collision(solid, True)

    def suspend(self, index: int) -> None:
        """Keep a slot where it is, whatever acts on it."""
        if index not in self._suspended:
            world = self._world
            self._suspended[index] = (world.positions[index], world.rotations[index])

    def resume(self, index: int) -> None:
        """Let a slot obey the physics again."""
        self._suspended.pop(index, None)

    def is_suspended(self, index: int) -> bool:
        """Whether a slot is kept where it is."""
        return index in self._suspended

    def moved(self, index: int) -> None:
        """A suspended slot was put somewhere else: keep it there."""
        if index in self._suspended:
            world = self._world
            self._suspended[index] = (world.positions[index], world.rotations[index])

    def before_step(self) -> None:
        """The tick begins."""
        if self._held or self._suspended:
            self._place()

    def after_step(self) -> None:
        """The tick ends; the poses of the holders are those of its beginning plus their motion."""
        if not self._held and not self._suspended:
            return
        self._world.sync()
        self._place()

    def _place(self) -> None:
        world = self._world
        for index, (position, rotation) in self._suspended.items():
            world.place(index, position, rotation)
            world.set_velocity(index, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for index, (holder, (offset, turned)) in self._held.items():
            world.place(index, *rigid.compose(*holder.world_pose(), offset, turned))
            world.set_velocity(index, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
