"""What the engine holds, and where everything is; no behaviour."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.layout import Motion
from morse.physics.rows import Rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    import mujoco
    from numpy.typing import NDArray

    from morse.physics.compile import Compiled, Slot
    from morse.scene import Node


class EngineState:
    """A compiled scene and the values that change while it runs.

    Rigid groups of nodes share a *slot*. Slots that the engine moves come first, so that slot ``k`` is MuJoCo body
    ``k + 1``.

    Attributes:
        model, data: the MuJoCo model and state; only this package touches them.
        slots: where each rigid group lives in the arrays of the engine.
        slot_of: index of the slot of each node.
        wheels: slot of a robot to the slots of its wheels.
        geom_node: node of each geom.
        steps: physics steps per tick.
        period: seconds per tick.
        moving: number of slots that the engine moves.
        engine_positions, engine_rotations: of those, as the engine has them now.
        by_hand: slots that only hands move: they have neither joints nor shapes.
        stamp: changes whenever anything has moved.
        displacements: changes whenever an object was put elsewhere in its slot.
        positions: of each slot, [x, y, z] in metres, world frame.
        rotations: of each slot, 9 row-major numbers.
        quaternions: w, x, y, z of each slot that was put somewhere by hand; of the others as at the start.
        touched: slots that were put elsewhere since the engine worked out where everything is.
        loose: slots that stand still in the scene, but were put elsewhere since.
        rearranged: nodes whose shapes moved within their slots since the rays looked at them.
        kinematic: linear and angular velocity, world axes, of slots that are moved without forces in this tick.
        has_forces: whether forces or torques wait for the next tick.
        is_stirred: whether something was done, since the last tick, to a body that does not glide.
        known_contacts: (N, 2) geoms that touched at the end of a tick that another engine did, or None.
        names: of the first node of each slot; ``named`` finds the slot by it.
    """

    def __init__(self, compiled: Compiled, period: float) -> None:
        self.take(compiled, period)

    def take(self, compiled: Compiled, period: float) -> None:
        """Begin with what was compiled, where the scene has it."""
        self.model: mujoco.MjModel = compiled.model
        self.data: mujoco.MjData = compiled.data
        self.slots: list[Slot] = compiled.slots
        self.geom_node: list[Node] = compiled.geom_node
        self.steps = compiled.steps
        self.period = period
        self.moving = sum(1 for slot in self.slots if slot.body > 0 and slot.frame.motion is not Motion.FIXED)
        self.engine_positions = self.data.xpos[1 : self.moving + 1]
        self.engine_rotations = self.data.xmat[1 : self.moving + 1]
        self.slot_of: dict[Node, int] = {
            node: index for index, slot in enumerate(self.slots) for node in slot.frame.members
        }
        self.wheels: dict[int, list[int]] = {}
        for index, slot in enumerate(self.slots):
            if slot.frame.parent is not None:
                self.wheels.setdefault(self.slot_of[slot.frame.parent.node], []).append(index)
        self.by_hand = tuple(
            index for index in range(self.moving, len(self.slots)) if self.slots[index].frame.motion is not Motion.FIXED
        )
        self.stamp = 0
        self.displacements = 0
        self.positions, self.rotations = Rows(np.zeros((0, 3))), Rows(np.zeros((0, 9)))
        self.quaternions: list[Sequence[float]] = []
        self.touched: set[int] = set()
        self.loose: set[int] = set()
        self.rearranged: set[Node] = set()
        self.kinematic: dict[int, tuple[Sequence[float], Sequence[float]]] = {}
        self.has_forces = False
        self.is_stirred = True
        self.known_contacts: NDArray[np.int32] | None = None
        self.names = tuple(slot.frame.node.name for slot in self.slots)
        self.named = {name: index for index, name in enumerate(self.names)}
