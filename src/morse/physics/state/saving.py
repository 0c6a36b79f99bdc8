"""Converts the whole state of a world to plain data and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from morse.physics.model.layout import Motion
from morse.physics.objects.properties import keep_unsaved
from morse.physics.poses import kinematics
from morse.physics.state import engine_values, saved

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from morse.core.values import StateData
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.physics.steps import Steps


class Saving:
    """Collects the states of all parts of a world, and restores them."""

    def __init__(self, world: ObjectWorld, gliding: Gliding, steps: Steps, objects: Mapping[str, GameObject]) -> None:
        self._world = world
        self._gliding = gliding
        self._steps = steps
        self._objects = objects

    def get_state(self) -> StateData:
        """See `World.get_state`; the structure is that of `morse.physics.state.saved.SavedWorld`."""
        world = self._world
        names = world.names
        by_hand = sorted({*world.by_hand, *world.touched, *world.loose, *world.relocated})
        data = world.data
        return {
            "version": saved.VERSION,
            "slots": names,
            "engine": engine_values.get_state(world),
            "placed": [
                {
                    "slot": names[index],
                    "position": tuple(world.positions[index]),
                    "rotation": tuple(world.rotations[index]),
                    "quaternion": tuple(world.quaternions[index]),
                }
                for index in by_hand
            ],
            "stale": [
                {
                    "slot": names[index],
                    "position": tuple(data.xpos[world.slots[index].body].tolist()),
                    "quaternion": tuple(data.xquat[world.slots[index].body].tolist()),
                }
                for index in sorted(world.touched)
                if index < world.moving
            ],
            "loose": [names[index] for index in sorted(world.loose)],
            "kinematic": [
                {"slot": names[index], "linear": tuple(linear), "angular": tuple(angular)}
                for index, (linear, angular) in world.kinematic.items()
            ],
            "objects": {name: state for name, obj in self._objects.items() if (state := obj.get_state())},
            "drives": world.drives.get_state(),
            "attachments": world.attachments.get_state(),
            "gliding": self._gliding.get_state(),
        }

    def checked(self, state: object) -> saved.SavedWorld:
        """Validate a state for this world and return it.

        Raises:
            ValueError: the state is damaged, or belongs to another scene; the message describes the problem.
        """
        world = self._world
        world_state = saved.checked(state)
        if world_state.slots != world.names:
            differing = sorted(set(world_state.slots) ^ set(world.names)) or ["the order"]
            raise ValueError(f"this state belongs to another scene: {', '.join(differing[:3])} differ")
        for name in _slots_of(world_state):
            if name not in world.named:
                raise ValueError(f"the state contains '{name}', which is not a body of this scene")
        for name in (*world_state.objects, *(grip.holder for grip in world_state.attachments.held)):
            if name not in self._objects:
                raise ValueError(f"the state contains '{name}', which does not exist in this scene")
        engine_values.check_state(world, world_state.engine)
        self._gliding.check_state(world_state.gliding)
        return world_state

    def set_state(self, state: saved.SavedWorld) -> None:
        """Restore a validated state."""
        world, slots_by_name = self._world, self._world.named
        world.bodies.moved_shapes.reset()
        self._gliding.forget_moved_shapes()
        # objects that are moved move shapes within slots, which must have their places; after a change there are others
        kinematics.place_as_compiled(world)
        before = [(obj.visible, obj.properties) for obj in self._objects.values()]
        # all objects are restored first, because an object that is moved also moves the objects below it
        for obj in self._objects.values():
            obj.restore()
        for (name, obj), (visible, present) in zip(self._objects.items(), before, strict=True):
            entry = state.objects.get(name)
            if entry is not None:
                obj.set_state(entry)
            keep_unsaved(present, obj.properties)
            if obj.visible != visible:
                world.appearance_changed(obj)
        engine_values.set_state(world, state.engine)
        kinematics.refresh(world, gliders=False)
        world.loose.clear()
        world.loose.update(slots_by_name[name] for name in state.loose)
        if any(world.slots[index].body == 0 for index in world.loose):
            world.bodies.moved_shapes.note(0)
        for pose in state.placed:
            index = slots_by_name[pose.slot]
            world.positions[index], world.rotations[index] = pose.position, pose.rotation
            world.quaternions[index] = pose.quaternion
            if world.slots[index].frame.motion is Motion.FIXED:
                world.relocated.add(index)
        for stale in state.stale:
            index = slots_by_name[stale.slot]
            world.touched.add(index)
            # the engine detects from the difference that a sleeping body was moved
            world.data.xpos[world.slots[index].body] = stale.position
            world.data.xquat[world.slots[index].body] = stale.quaternion
        world.drives.set_state(state.drives)
        world.kinematic.update({slots_by_name[e.slot]: (e.linear, e.angular) for e in state.kinematic})
        world.attachments.set_state(state.attachments, self._objects)
        self._gliding.set_state(state.gliding)
        kinematics.refresh_gliders(world)
        self._steps.reset()
        world.rearranged.update(world.slot_of)


class _OfSlot(Protocol):
    @property
    def slot(self) -> str: ...


def _slots_of(state: saved.SavedWorld) -> Iterator[str]:
    """Iterate over all slots in a state."""
    drives, attachments, gliding = state.drives, state.attachments, state.gliding
    yield from (*state.loose, *drives.sliding)
    groups: tuple[Sequence[_OfSlot], ...] = (
        state.placed,
        state.stale,
        state.kinematic,
        drives.commands,
        attachments.held,
        attachments.suspended,
        gliding.glides,
        gliding.stands,
    )
    for group in groups:
        for entry in group:
            yield entry.slot
