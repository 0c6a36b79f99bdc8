"""Masses and frictions that are changed while a simulation runs."""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING

import mujoco

from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from morse.physics.model.layout import Slot
    from morse.physics.objects.object_world import ObjectWorld, Posed
    from morse.scene import Node

#: the arrays of the model that a variation changes
ARRAYS = ("body_mass", "body_inertia", "body_subtreemass", "body_invweight0", "dof_invweight0", "geom_friction")
#: largest ratio of a mass to that of the scene, either way
_MOST = 1e4
#: bodies with a mass of their own, and how many of them a message names
_WITH_MASS, _SHOWN = (Motion.FREE, Motion.JOINT), 8
#: largest coefficient of friction
_ROUGHEST = 100.0


class Variations:
    """Changes the mass of bodies and the friction of their shapes.

    Args:
        pristine: the arrays of the model as compiled.
    """

    def __init__(self, world: ObjectWorld, pristine: Mapping[str, NDArray[np.float64]]) -> None:
        self._world, self._pristine = world, pristine

    def set_mass(self, obj: Posed, mass: float) -> None:
        """Set the mass of a body, or of a link on a joint, kg; its inertia changes in proportion.

        Raises:
            ValueError: the object is not a dynamic body, or the mass differs by more than 10,000 from that of the
                scene.
        """
        self.check(obj, "mass", mass)
        slot, model = self._world.slots[obj.slot], self._world.model
        first = float(self._pristine["body_mass"][slot.body])
        ratio = mass / first
        dofs = slice(slot.dof, slot.dof + 6)
        for name in ("body_mass", "body_inertia"):
            getattr(model, name)[slot.body] = self._pristine[name][slot.body] * ratio
        self._world.is_stirred = True
        if slot.frame.motion is Motion.JOINT:
            self._renew_constants()
            return
        model.body_subtreemass[slot.body] = self._pristine["body_subtreemass"][slot.body] + (mass - first)
        # how strongly contacts and limits resist: the inverse of the mass
        model.body_invweight0[slot.body] = self._pristine["body_invweight0"][slot.body] / ratio
        model.dof_invweight0[dofs] = self._pristine["dof_invweight0"][dofs] / ratio

    def _renew_constants(self) -> None:
        """Let the engine compute what follows from the masses of links: these depend on the links beyond them."""
        model = self._world.model
        other = copy.copy(model)
        mujoco.mj_setConst(other, mujoco.MjData(other))
        for name in ("body_subtreemass", "body_invweight0", "dof_invweight0"):
            getattr(model, name)[:] = getattr(other, name)

    def set_friction(self, obj: Posed, friction: float) -> None:
        """Set the coefficient of sliding friction of all shapes of a body and of the links that its joints carry.

        It is that of all of their contacts.

        Raises:
            ValueError: it is not a number from 0 to 100, or the object has no shapes.
        """
        self.check(obj, "friction", friction)
        for slot in self._carried(self._world.slots[obj.slot]):
            self._rub(slot, friction)

    def _rub(self, slot: Slot, friction: float) -> None:
        for geom in _geoms(slot):
            self._world.model.geom_friction[geom, 0] = friction
            self._world.model.geom_priority[geom] = 2
        self._world.is_stirred = True

    def _carried(self, slot: Slot) -> list[Slot]:
        """A body, and all that move on its joints, such as legs and their feet."""
        if slot.body <= 0:
            return [slot]
        parents = self._world.model.body_parentid

        def is_carried(body: int) -> bool:
            while body > slot.body:  # the number of a parent is the lower one
                body = int(parents[body])
            return body == slot.body

        return [other for other in self._world.slots if is_carried(other.body)]

    def check(self, obj: Posed, what: str, value: float) -> None:
        """Raise the error of `set_mass` or `set_friction`; ``what`` is ``mass`` or ``friction``."""
        slot, name = self._world.slots[obj.slot], obj.node.name
        if what == "mass":
            if slot.frame.motion not in _WITH_MASS:
                links = [node.name for node in obj.node.walk() if self._moves_on_a_joint(node)]
                mend = f"; set that of one of its links: {', '.join(links[:_SHOWN])}" if links else ""
                raise ValueError(
                    f"'{name}' is neither a body that moves freely nor on a joint: it has no mass to set{mend}"
                )
            first = float(self._pristine["body_mass"][slot.body])
            low, high = first / _MOST, first * _MOST
            if not low <= value <= high:  # not true of NaN
                raise ValueError(f"the mass of '{name}' is {value!r}, expected {low:g} to {high:g} kg")
        else:
            if not 0.0 <= value <= _ROUGHEST:
                raise ValueError(f"the friction of '{name}' is {value!r}, expected 0 to {_ROUGHEST:g}")
            if not any(_geoms(other) for other in self._carried(slot)):
                raise ValueError(f"'{name}' has no shapes that collide: it has no friction to set")

    def _moves_on_a_joint(self, node: Node) -> bool:
        slot = self._world.slots[self._world.object_of(node).slot]
        return slot.frame.motion is Motion.JOINT and slot.frame.node is node

    def present(self) -> dict[str, tuple[float | None, float | None]]:
        """Return the bodies whose values are not those of the scene: name to mass and friction, None if unchanged."""
        model, changed = self._world.model, dict[str, tuple[float | None, float | None]]()
        for slot in self._world.slots:
            mass = friction = None
            if slot.body > 0 and model.body_mass[slot.body] != self._pristine["body_mass"][slot.body]:
                mass = float(model.body_mass[slot.body])
            for geom in _geoms(slot):
                if model.geom_friction[geom, 0] != self._pristine["geom_friction"][geom, 0]:
                    friction = float(model.geom_friction[geom, 0])
            if mass is not None or friction is not None:
                changed[slot.frame.node.name] = mass, friction
        return changed

    def apply(self, changed: Mapping[str, tuple[float | None, float | None]]) -> None:
        """Set values again, in a model that was compiled again; bodies that do not exist any more are left out."""
        for name, (mass, friction) in changed.items():
            index = self._world.named.get(name)
            if index is None:
                continue
            obj = self._world.object_of(self._world.slots[index].frame.node)
            if mass is not None and math.isfinite(mass) and self._world.slots[index].frame.motion in _WITH_MASS:
                self.set_mass(obj, mass)
            if friction is not None:
                self._rub(self._world.slots[index], friction)


def _geoms(slot: Slot) -> list[int]:
    return [geom for geoms in slot.geoms.values() for geom in geoms]
