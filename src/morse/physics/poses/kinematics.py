"""Computes the poses of all slots from the state of the engine, and converts rows of them on demand."""

from __future__ import annotations

from struct import Struct
from typing import TYPE_CHECKING, overload

import mujoco
import numpy as np

from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState


#: maximum size of a block of arrays, bytes: so much stays in the cache of a processor
_BLOCK = 1 << 16
#: maximum and minimum number of arrays in a block
_MOST, _LEAST = 64, 4


class Rows:
    """The rows of an array for scalar code.

    After `share`, the caller owns the array; the rows are copied before the next write. Arrays for `take` are made in
    advance, many at once: creating one takes several times as long as filling it.

    Args:
        array: (N, D).
        taken: number of the first rows that `take` replaces.

    Attributes:
        array: all rows (N, D); the array must be read immediately and not be modified.
        place: the address of the array; 0 if it is not known, because it takes a while to find out.
    """

    __slots__ = ("_first", "_is_shared", "_made", "_none", "_row", "_rows", "_size", "array", "place")

    def __init__(self, array: NDArray[np.float64], count: int = 0) -> None:
        self.array = array
        self._first = array[:count]
        self._is_shared = False
        self._row = Struct(f"={array.shape[1]}d")
        self._size = self._row.size
        self._rows: list[Sequence[float] | None] = [None] * len(array)
        self._none: list[Sequence[float] | None] = [None] * count
        #: copies of the array, the first rows of each, and its address
        self._made: list[tuple[NDArray[np.float64], NDArray[np.float64], int]] = []
        self.place = 0

    def take(self, values: NDArray[np.float64], rows: NDArray[np.intp] | None = None) -> None:
        """Set new values for the first rows.

        Args:
            values: (M, D).
            rows: the rows of ``values`` to take; None for all.
        """
        if self._is_shared:
            self._is_shared = False
            view = self._made
            if not view:
                view += self._copies()
            if view:
                self.array, self._first, self.place = view.pop()
            else:
                self.place = 0
                self.array = self.array.copy()
                self._first = self.array[: len(self._none)]
        if rows is None:
            self._first[...] = values
        else:
            values.take(rows, 0, self._first, "clip")
        self._rows[: len(self._none)] = self._none

    def _copies(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64], int]]:
        """Return copies for the next calls of `take`; none of a large array."""
        array, count = self.array, len(self._none)
        number = min(_MOST, _BLOCK // max(array.nbytes, 1))
        if number < _LEAST:
            return []
        block = np.empty((number, *array.shape))
        block[:, count:] = array[count:]
        begin = block.ctypes.data
        places = range(begin, begin + block.nbytes, array.nbytes)
        return list(zip(block, block[:, :count], places, strict=True))[::-1]

    def _own(self) -> None:
        if self._is_shared:
            self.array = self.array.copy()
            self._first = self.array[: len(self._none)]
            self._is_shared, self.place = False, 0

    def share(self) -> NDArray[np.float64]:
        """Return all present rows (N, D); the array does not change afterwards."""
        self._is_shared = True
        return self.array

    def __len__(self) -> int:
        return len(self._rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rows) and np.array_equal(self.array, other.array, equal_nan=True)

    __hash__ = None  # type: ignore[assignment]

    @overload
    def __getitem__(self, index: int) -> Sequence[float]: ...

    @overload
    def __getitem__(self, index: slice) -> list[Sequence[float]]: ...

    def __getitem__(self, index: int | slice) -> Sequence[float] | list[Sequence[float]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        row = self._rows[index]
        if row is None:
            # takes a third of the time of reading from the array
            row = self._rows[index] = self._row.unpack_from(self.array, self._size * index)  # type: ignore[arg-type]
        return row

    def put(self, index: NDArray[np.intp], values: NDArray[np.float64]) -> None:
        """Replace some rows (M,) by values (M, D)."""
        self._own()
        self._made.clear()
        self.array[index] = values
        rows = self._rows
        for row in index.tolist():
            rows[row] = None

    def __setitem__(self, index: int, values: Sequence[float]) -> None:
        self._own()
        self._made.clear()
        self.array[index] = values
        self._rows[index] = values


_UNTURNED = (1.0, 0.0, 0.0, 0.0)
#: time of the difference between positions that gives the velocities of vertices, s
_MOMENT = 1e-5


class Flexes:
    """Reads the vertices of deformable bodies, which are slots, and place the bodies at their means.

    Args:
        flexes: see `morse.physics.model.compile.Compiled`.
    """

    def __init__(self, model: mujoco.MjModel, flexes: Sequence[tuple[int, int, Sequence[int]]]) -> None:
        self._slots = np.array([slot for _, slot, _ in flexes], dtype=np.intp)
        self._vertices = np.array([vertex for _, _, vertices in flexes for vertex in vertices], dtype=np.intp)
        firsts = [int(model.flex_vertadr[number]) for number, _, _ in flexes]
        counts = [len(vertices) for _, _, vertices in flexes]
        self._rows = np.concatenate([np.arange(a, a + n) for a, n in zip(firsts, counts, strict=True)])
        self._begins = np.cumsum([0, *counts[:-1]])
        self._counts = np.array(counts, dtype=np.float64)[:, None]
        self._moment = -1
        self._velocities: dict[int, Sequence[float]] = {}
        self._later: mujoco.MjData | None = None

    def __contains__(self, slot: int) -> bool:
        return slot in self._slots or slot in self._vertices

    def velocity(self, state: EngineState, slot: int) -> Sequence[float]:
        """Return the velocity of a vertex, or the mean of those of a body, m/s, in the axes of the world.

        It is the difference to the positions a moment later, because vertices may follow several bodies of the engine.
        """
        if self._moment != state.stamp:
            model, now = state.model, state.data
            later = self._later = self._later or mujoco.MjData(model)
            for name in ("qpos", "mocap_pos", "mocap_quat", "eq_active"):
                getattr(later, name)[:] = getattr(now, name)
            mujoco.mj_integratePos(model, later.qpos, now.qvel, _MOMENT)
            mujoco.mj_kinematics(model, later)
            mujoco.mj_flex(model, later)
            rows = (later.flexvert_xpos.take(self._rows, 0) - now.flexvert_xpos.take(self._rows, 0)) / _MOMENT
            means = np.add.reduceat(rows, self._begins, axis=0) / self._counts
            self._velocities = dict(zip(self._vertices.tolist(), rows.tolist(), strict=True))
            self._velocities.update(zip(self._slots.tolist(), means.tolist(), strict=True))
            self._moment = state.stamp
        return self._velocities[slot]

    def read(self, state: EngineState) -> None:
        """Take over the positions of the vertices, after the kinematics of the engine."""
        mujoco.mj_flex(state.model, state.data)
        points = state.data.flexvert_xpos.take(self._rows, 0)
        state.positions.put(self._vertices, points)
        state.positions.put(self._slots, np.add.reduceat(points, self._begins, axis=0) / self._counts)
        state.rotations.put(self._slots, np.tile(np.eye(3).ravel(), (len(self._slots), 1)))
        for slot in self._slots.tolist():
            state.quaternions[slot] = _UNTURNED


#: value of `contact.exclude` of the engine for contacts within a gap
IN_GAP = 1


def place_as_compiled(state: EngineState) -> None:
    """Set every slot to its pose in the scene."""
    if len(state.compiled_poses[0]) != len(state.slots):
        turns = [tuple(float(v) for row in slot.pose.rotation for v in row) for slot in state.slots]
        places = np.array([slot.pose.position for slot in state.slots], np.float64).reshape(-1, 3)
        state.compiled_poses = places, np.array(turns).reshape(-1, 9), list(map(rigid.quaternion, turns))
    places, rotations, quaternions = state.compiled_poses
    state.positions, state.rotations = Rows(places.copy(), state.moving), Rows(rotations.copy(), state.moving)
    state.relocated.clear()
    state.quaternions = list(quaternions)


def sync(state: EngineState) -> None:
    """Compute all poses from the present state."""
    mujoco.mj_kinematics(state.model, state.data)
    refresh(state)


def refresh(state: EngineState, *, gliders: bool = True) -> None:
    """Copy the poses of the moving bodies from the engine.

    Args:
        gliders: whether the robots that glide keep the poses of the kernel; False while it is not known which ones do.
    """
    state.positions.take(state.engine_positions, state.engine_rows)
    state.rotations.take(state.engine_rotations, state.engine_rows)
    if gliders and state.write_gliders is not None:
        state.write_gliders(state.positions, state.rotations)
    if state.flexes is not None:
        state.flexes.read(state)
    state.touched.clear()
    state.stamp += 1


def refresh_gliders(state: EngineState) -> None:
    """Copy the poses of the robots that glide, after others were known to glide than at the last `refresh`."""
    if state.write_gliders is not None:
        # the rows of the bodies that the engine moves, which may be shared, are taken again
        for rows in (state.positions, state.rotations):
            rows.take(rows.array[: state.moving].copy())
        state.write_gliders(state.positions, state.rotations)


def settle_fixed(state: EngineState) -> None:
    """Update the poses of static bodies, after one of them was moved by an explicit call."""
    # with sleeping enabled, the engine computes the poses of static bodies only once
    flags = state.model.opt.enableflags
    state.model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    mujoco.mj_kinematics(state.model, state.data)
    state.model.opt.enableflags = flags


def contact_pairs(state: EngineState) -> NDArray[np.int32]:
    """Return (N, 2) pairs of geoms that were in contact in the last step of the engine.

    Without those within the gaps around gliding robots.
    """
    if state.known_contacts is not None:
        return state.known_contacts
    contact = state.data.contact
    geoms = np.asarray(contact.geom)
    if state.flexes is not None:
        # the shape that stands for them is the last one
        geoms = np.where(geoms < 0, state.model.ngeom - 1, geoms).astype(np.int32)
    if not state.has_gaps:
        return geoms
    state.known_contacts = geoms[np.asarray(contact.exclude) != IN_GAP]
    return state.known_contacts
