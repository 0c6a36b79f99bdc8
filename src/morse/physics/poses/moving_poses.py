"""The poses of moving nodes, for the view."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.physics.model.layout import Motion
from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node


class Part(Protocol):
    """An object that can move relative to its parent; see `morse.physics.objects.gameobject.GameObject`."""

    node: Node
    slot: int

    def local_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9) in the frame of the parent."""


class MovingPoses:
    """The poses of the moving slots, of static slots that calls have moved, and of parts that moved within slots.

    The order of the nodes follows from the scene, not from the order in which they moved: a run that was restarted or
    restored has the order of one that was launched.

    Attributes:
        displaced: the parts that moved relative to their parents, in the order of the scene.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        self.displaced: list[Part] = []
        self._layout = 0
        self._relocated: tuple[int, ...] = ()
        self._noted: dict[Part, None] = {}
        self._is_stale = False
        self._ranks: dict[Node, int] = {}

    @property
    def layout(self) -> int:
        """A number that changes whenever a moving node is added or removed."""
        relocated = self._state.relocated
        if len(relocated) != len(self._relocated) or not relocated.issuperset(self._relocated):
            self._relocated = tuple(sorted(relocated))
            self._layout += 1
        if self._is_stale:
            self._is_stale = False
            self._ranks = self._ranks or {node: rank for rank, node in enumerate(self._state.slot_of)}
            displaced = sorted(self._noted, key=lambda part: self._ranks[part.node])
            if displaced != self.displaced:
                self.displaced = displaced
                self._layout += 1
        return self._layout

    def follow(self, before: MovingPoses) -> None:
        """Replace the poses before a change of the scene, whose nodes may be gone."""
        self._layout = before._layout + 1

    def note_displaced(self, part: Part) -> None:
        """Record that a node has moved relative to its parent."""
        if part not in self._noted and self._state.slots[part.slot].frame.node is not part.node:
            self._noted[part] = None
            self._is_stale = True

    def put_back(self) -> Iterable[Part]:
        """All parts are at their places in the scene again; return those that were not."""
        parts, self._noted = self._noted, {}
        self._is_stale = self._is_stale or bool(parts)
        return parts

    def nodes(self) -> list[tuple[Node, str]]:
        """Return the nodes in the order of `read`, each with its frame, ``world`` or ``parent``."""
        slots, _ = self._state.slots, self.layout
        nodes = [(slot.frame.node, "world") for slot in slots if slot.frame.motion is not Motion.FIXED]
        nodes += [(slots[index].frame.node, "world") for index in self._relocated]
        return nodes + [(part.node, "parent") for part in self.displaced]

    def read(self) -> NDArray[np.float32]:
        """Return (M, 7) x, y, z, qw, qx, qy, qz of the moving nodes, in the order of `nodes`."""
        state, _ = self._state, self.layout
        rest = [*state.by_hand, *self._relocated] if self._relocated else state.by_hand
        count = state.moving
        end = count + len(rest)
        result = np.empty((end + len(self.displaced), 7), dtype=np.float32)
        result[:count, :3] = state.data.xpos[1 : count + 1]
        result[:count, 3:] = state.data.xquat[1 : count + 1]
        # a flat sequence of numbers is converted twice as fast as rows
        positions = chain.from_iterable([state.positions[i] for i in rest])
        quaternions = chain.from_iterable([state.quaternions[i] for i in rest])
        result[count:end, :3] = np.fromiter(positions, np.float32, 3 * len(rest)).reshape(-1, 3)
        result[count:end, 3:] = np.fromiter(quaternions, np.float32, 4 * len(rest)).reshape(-1, 4)
        for row, part in enumerate(self.displaced, end):
            position, rotation = part.local_pose()
            result[row, :3] = position
            result[row, 3:] = rigid.quaternion(rotation)
        return result
