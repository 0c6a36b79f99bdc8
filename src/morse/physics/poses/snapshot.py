"""Poses of objects at one moment, computed on demand; at many moments; and those of moving nodes, for the view."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from morse.mathutils.portable import matmul
from morse.mathutils.rotation_rows import stacked
from morse.mathutils.rotations import product, turn
from morse.physics.model.layout import Motion
from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.physics.poses.rigid import Mounted, Mounting
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node

    #: the numbers of positions (3) or rotations (9), each (R, N)
    Numbers = Sequence[NDArray[np.float64]]


_NONE, _MOVED, _TURNED = 0, 1, 2


class Mountings(NamedTuple):
    """The places of N objects in their rigid groups.

    Attributes:
        numbers: (12, N) offsets, m, and rotations, row by row.
        apart: (N,) whether an object has the pose of its group (0), is moved (1), or moved and turned (2).
    """

    numbers: NDArray[np.float64]
    apart: NDArray[np.uint8]

    @classmethod
    def of(cls, mountings: Sequence[Mounting]) -> Mountings:
        """Take over the places."""
        numbers = np.array([[*one.offset, *one.turned] for one in mountings], dtype=np.float64).reshape(-1, 12)
        ways = [(_TURNED if one.is_turned else _MOVED) if one.is_apart else _NONE for one in mountings]
        return cls(numbers.T, np.array(ways, dtype=np.uint8))


class PoseRows(NamedTuple):
    """The poses of rigid groups at R moments.

    Attributes:
        positions, rotations: (R, K, 3) m, (R, K, 9) of the groups.
        mountings: those of the moments, without repetition.
        places: (R,) which of them are those of a moment.
    """

    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    mountings: Sequence[Mountings]
    places: NDArray[np.intp]

    @classmethod
    def of(
        cls,
        positions: Sequence[NDArray[np.float64]],
        rotations: Sequence[NDArray[np.float64]],
        mountings: Sequence[Sequence[Mounting]],
    ) -> PoseRows:
        """Put R moments together.

        Args:
            positions, rotations: of the groups, (K, 3) m and (K, 9) each.
            mountings: of the objects, N each.
        """
        distinct = {id(one): one for one in mountings}
        if len(distinct) == 1:
            places = np.zeros(len(mountings), dtype=np.intp)
        else:
            numbers = {key: place for place, key in enumerate(distinct)}
            places = np.array([numbers[id(one)] for one in mountings], dtype=np.intp)
        each = [Mountings.of(one) for one in distinct.values()]
        return cls(stacked(positions), stacked(rotations), each, places)

    def carried(self, slots: NDArray[np.intp] | Sequence[int] | slice) -> tuple[Numbers, Numbers]:
        """The poses (R, N) of objects in the world, as by `Mounting.carried`."""
        p: list[NDArray[np.float64]] = list(self.positions[:, slots].transpose(2, 0, 1))
        r: list[NDArray[np.float64]] = list(self.rotations[:, slots].transpose(2, 0, 1))
        if any(one.apart.any() for one in self.mountings):
            apart = np.stack([one.apart for one in self.mountings])
            own = np.stack([one.numbers for one in self.mountings])
            if len(own) > 1:  # else the places are the same at all moments
                apart, own = apart[self.places], own[self.places]
            moved = turn(r, [own[:, k] for k in range(3)])  # type: ignore[arg-type, misc]
            p = [np.where(apart != _NONE, a + b, a) for a, b in zip(p, moved, strict=True)]
            if (apart == _TURNED).any():
                turned = product(tuple(r), tuple(own[:, k] for k in range(3, 12)))  # type: ignore[arg-type, misc]
                r = [np.where(apart == _TURNED, b, a) for a, b in zip(r, turned, strict=True)]
        return p, r


class Snapshot:
    """The poses of some objects at one moment.

    Args:
        positions, rotations: (K, 3), (K, 9) poses of all rigid groups; these arrays never change.
        slots: groups of the objects.
        mountings: poses of the objects in their groups.

    Attributes:
        group_positions, group_rotations, slots, mountings: the arguments.
    """

    __slots__ = ("group_positions", "group_rotations", "mountings", "slots")

    def __init__(
        self,
        positions: NDArray[np.float64],
        rotations: NDArray[np.float64],
        slots: Sequence[int],
        mountings: Sequence[Mounting],
    ) -> None:
        self.group_positions, self.group_rotations = positions, rotations
        self.slots, self.mountings = slots, mountings

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the position (3) and rotation (9, row by row) of an object in the world."""
        slot = self.slots[row]
        return self.mountings[row].carried(self.group_positions[slot].tolist(), self.group_rotations[slot].tolist())

    @classmethod
    def poses_at(cls, moments: Sequence[Snapshot]) -> tuple[Numbers, Numbers]:
        """Return the positions (3) and rotations (9, row by row) of the same N objects at R moments, (R, N) each."""
        positions, rotations = [one.group_positions for one in moments], [one.group_rotations for one in moments]
        return PoseRows.of(positions, rotations, [one.mountings for one in moments]).carried(moments[0].slots)

    def positions(self) -> NDArray[np.float64]:
        """Return the positions (N, 3) in the world, m."""
        rotations = self.group_rotations[self.slots]
        offsets = np.array([mounting.offset for mounting in self.mountings])
        x, y, z = offsets.T
        columns = [rotations[:, k] * x + rotations[:, k + 1] * y + rotations[:, k + 2] * z for k in (0, 3, 6)]
        result: NDArray[np.float64] = self.group_positions[self.slots] + np.stack(columns, axis=1)
        return result

    def rotations(self) -> NDArray[np.float64]:
        """Return the rotations (N, 3, 3) from the axes of each object to those of the world."""
        offsets = np.array([mounting.turned for mounting in self.mountings]).reshape(-1, 3, 3)
        return np.asarray(matmul(self.group_rotations[self.slots].reshape(-1, 3, 3), offsets))


class Snapshots:
    """Takes snapshots of the same objects repeatedly, at little cost."""

    def __init__(self, state: EngineState, objects: Sequence[Mounted]) -> None:
        self._state, self._objects = state, objects
        self._slots = [obj.slot for obj in objects]
        self._index, self._rows = np.array(self._slots, dtype=np.int64), range(len(self._slots))
        self._displacements = -1
        self._mountings: list[Mounting] = []
        #: whether the engine moves all of them; None if that is not known
        self._moves: bool | None = None

    def place(self, row: int) -> tuple[int, Mounting]:
        """Return the group of an object, and its pose in the group."""
        if self._displacements != self._state.displacements:
            self._look()
        return self._slots[row], self._mountings[row]

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses, with copies of those of the rigid groups of the objects."""
        state, index = self._state, self._index
        if self._displacements != state.displacements:
            self._look()
        positions, rotations = state.positions.array.take(index, 0), state.rotations.array.take(index, 0)
        return Snapshot(positions, rotations, self._rows, self._mountings)

    def before(self) -> Snapshot:
        """Return a snapshot of the poses at the beginning of the last tick of `World.advance`."""
        state, index = self._state, self._index
        if self._displacements != state.displacements:
            self._look()
        before_positions, before_rotations = state.poses_before
        if self._moves is None:
            self._moves = bool((index < state.moving).all())
        if self._moves:
            positions, rotations = before_positions.take(index, 0), before_rotations.take(index, 0)
        else:
            positions, rotations = state.positions.array.take(index, 0), state.rotations.array.take(index, 0)
            rows = np.flatnonzero(index < state.moving)
            positions[rows], rotations[rows] = before_positions[index[rows]], before_rotations[index[rows]]
        return Snapshot(positions, rotations, self._rows, self._mountings)

    def _look(self) -> None:
        self._displacements = self._state.displacements
        self._mountings = [obj.mounting for obj in self._objects]


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
        # bodies of a model file that are fixed are among those that move
        bodies = slice(1, count + 1) if state.engine_rows is None else state.engine_rows
        result[:count, :3] = state.data.xpos[bodies]
        result[:count, 3:] = state.data.xquat[bodies]
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
