"""The steps of the engine in many worlds at once, on several threads.

The states of the worlds are rows of one array, with which the engine steps them in one call. The worlds themselves do
not change meanwhile: `EngineRows.give_back` sets the state from before the last call in a world.
"""

from __future__ import annotations

import ctypes
import os
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakSet

import mujoco
import numpy as np
from mujoco.batch import Batch, SimulationError

from morse.kernel import threads
from morse.kernel.joints import JointRows, Sizes
from morse.physics.model.layout import Motion
from morse.physics.model.placement import lowest_shape
from morse.physics.poses import kinematics
from morse.physics.poses.convert import RUNAWAY_DISTANCE, RUNAWAY_SPEED
from morse.physics.state.engine_state import SLIP
from morse.physics.state.engine_values import STATE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.physics.world import World

#: a body that is so far below everything has left the world, which somebody reports, m
_BELOW = 5.0
#: share of the limits of positions and speeds; beyond it, the world itself finds out which body diverges
_NEAR = 0.5
_LIMITS = _NEAR * RUNAWAY_DISTANCE, _NEAR * RUNAWAY_SPEED, SLIP


_RESTING_AT_FORK: WeakSet[EngineRows] = WeakSet()


def _rest_all() -> None:
    for rows in list(_RESTING_AT_FORK):
        rows.rest()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_rest_all)


@cache
def _functions() -> tuple[int, int]:
    """The addresses of ``mju_normalize4`` and ``mju_quat2Mat`` in the library of the engine, which is loaded."""
    folder = Path(mujoco.__file__).parent
    names = (name for name in os.listdir(folder) if re.fullmatch(r"(lib)?mujoco[.\d]*\.(dll|dylib|so)[.\d]*", name))
    engine = ctypes.CDLL(str(folder / next(names)))
    each = [ctypes.cast(function, ctypes.c_void_p).value for function in (engine.mju_normalize4, engine.mju_quat2Mat)]
    return each[0] or 0, each[1] or 0


def _sizes(batch: Batch) -> Sizes:
    model, begin = batch.model, batch.state.ctypes.data
    positions, speeds, motors = (
        (batch.bind(name).ctypes.data - begin) // batch.state.itemsize for name in ("qpos", "qvel", "ctrl")
    )
    return Sizes(batch.state.shape[1], positions, model.nq, speeds, model.nv, motors)


class EngineRows:
    """N worlds with models of the same sizes.

    Args:
        world: one of them.
        rows: N.

    Attributes:
        kernel: the states, and what is done with them beside the engine.
        positions, rotations: (N, K, 3) m, (N, K, 9): poses of the rigid groups, which `place` updates.
        joints, speeds: (N, nq), (N, nv) positions and speeds of the joints, as the engine stores them.
    """

    def __init__(self, world: World, rows: int) -> None:
        self._models = [world.model] * rows
        batch, groups, free = Batch(world.model, rows, threads.count()), len(world.positions), len(_free_of(world))
        objects = len(world.sliding.dofs)
        self.kernel = JointRows(rows, groups, free, objects, _sizes(batch), _LIMITS, _functions())
        self.positions, self.rotations = self.kernel.positions, self.kernel.rotations
        self._take(batch)
        #: while the engine rests
        self._state = batch.state.copy()
        self._is_busy = False
        self._worlds: list[World | None] = [None] * rows
        #: model, data and arrays of each world, and where poses are written to
        self._poses: list[tuple[Any, ...]] = [()] * rows
        #: steps of the engine in a tick, and the different numbers
        self._counts: set[int] = set()
        self._steps, self._moves = np.zeros(rows, np.int64), np.zeros((rows, len(world.positions)), bool)
        #: rows whose poses are all needed, not those of the free bodies alone
        self._whole: list[int] = []
        _RESTING_AT_FORK.add(self)

    def _wake(self) -> Batch:
        """Return what steps the engine; its threads begin if it rests."""
        batch = self._batch
        if batch is None:
            batch = Batch(self._models[0], len(self._models), threads.count())
            batch.state[:] = self._state
            self._take(batch)
        return batch

    def _take(self, batch: Batch) -> None:
        """Use what steps the engine."""
        self._batch: Batch | None = batch
        self.joints, self.speeds = batch.bind("qpos"), batch.bind("qvel")
        self.kernel.use(batch.state, batch.bind("ncon"), batch.warning)
        #: whether models have changed since the engine has taken note of them
        self._has_news = True

    def rest(self) -> None:
        """End the threads until the next call, because a process that is forked has none of them, and would wait."""
        if self._batch is not None and not self._is_busy:
            self._state[:] = self._batch.state
            # arrays of the engine would keep its threads
            self.joints = self.speeds = np.zeros((0, 0))
            self.kernel.use(self._state, np.zeros(0, np.int32), np.zeros((0, 0, 2), np.int32))
            self._batch = None

    def add(self, row: int, world: World) -> bool:
        """Take the state of a world; return whether nothing but the engine has work in its next ticks."""
        if not world.only_steps():
            return False
        is_new = self._worlds[row] is not world or self._models[row] is not world.model
        if is_new and not self._fits(row, world):
            return False
        self._has_news = True
        poses = self._poses[row]
        self.positions[row], self.rotations[row] = world.positions.array, world.rotations.array
        if self.positions[row, : world.moving, 2].min(initial=np.inf) < self.kernel.lowest[row]:
            return False
        mujoco.mj_getState(world.model, world.data, self._wake().state[row], STATE)
        return bool(poses)

    def _fits(self, row: int, world: World) -> bool:
        """Use another world, or another model of it; return whether its sizes are those of the others."""
        kernel, model, before, free = self.kernel, world.model, self._models[row], _free_of(world)
        self._worlds[row], self._poses[row] = world, ()
        objects = world.sliding.dofs[:, 0] if world.sliding.has_objects else []
        if len(world.positions) != self.positions.shape[1] or len(free) > kernel.free_groups.shape[1]:
            return False
        if len(objects) > kernel.objects.shape[1]:
            return False
        self._models[row] = model
        try:
            self._wake().set_models(self._models)
        except mujoco.FatalError:
            self._models[row] = before
            return False
        bodies, moving = world.engine_rows, world.moving
        self._poses[row] = (
            model,
            world.data,
            world.data.qpos,
            world.engine_positions,
            world.engine_rotations.reshape(-1, 9),
            self.positions[row, :moving],
            self.rotations[row, :moving],
            np.arange(moving) if bodies is None else bodies,
        )
        self._steps[row] = world.steps
        self._counts = set(self._steps[self._steps > 0].tolist())
        self._moves[row] = np.arange(len(world.positions)) < moving
        kernel.free_groups[row], kernel.free_places[row] = -1, -1
        for number, (group, place) in enumerate(free):
            kernel.free_groups[row, number], kernel.free_places[row, number] = group, place
        kernel.objects[row] = -1
        kernel.objects[row, : len(objects)] = np.add(objects, kernel.sizes.speeds)
        kernel.most[row], kernel.lowest[row] = world.most_contacts, lowest_shape(world)[0] - _BELOW
        return True

    def begin(self, ticks: int) -> None:
        """Begin a call of some ticks of the rows ``kernel.going``: `give_back` returns to this time."""
        batch = self._wake()
        if self._has_news:
            batch.set_models(self._models)
            self._has_news = False
        self.kernel.begin(ticks)

    def run(self, *, is_last: bool) -> None:
        """Run a tick of the rows ``kernel.going``, the last one of a call or another.

        Those in which something has happened that the world itself has to deal with are removed from them.
        """
        batch, going = self._wake(), self.kernel.going
        self._is_busy = True
        try:
            for count in self._counts:
                chosen = None
                if len(self._counts) > 1 or not going.all():
                    chosen = np.flatnonzero(going & (self._steps == count))
                try:
                    batch.step(chosen, count)
                except SimulationError:
                    batch.warning[chosen, 0, 1] += batch.status[chosen] != 0
        finally:
            self._is_busy = False
        self.kernel.check(is_last=is_last)

    def read(self, row: int, groups: Iterable[int] | None) -> None:
        """Say which poses of a row are needed.

        Args:
            groups: the rigid groups; None for all.
        """
        moving, free = np.count_nonzero(self._moves[row]), set(self.kernel.free_groups[row].tolist())
        needed = range(moving) if groups is None else [group for group in groups if group < moving]
        self.kernel.alone[row] = is_alone = free.issuperset(needed)
        self._whole = [one for one in self._whole if one != row]
        if not is_alone:
            self._whole.append(row)

    def place(self, ticks: int) -> None:
        """Compute the poses of the rows at the end of a call; those are removed whose bodies have left the world."""
        if self._whole:
            self._place_all([row for row in self._whole if self.kernel.going[row]])
        self.kernel.settle(ticks)

    def _place_all(self, rows: Sequence[int]) -> None:
        """Compute the poses of all groups."""
        for row in rows:
            model, data, qpos, xpos, xmat, positions, rotations, bodies = self._poses[row]
            qpos[:] = self.joints[row]
            mujoco.mj_kinematics(model, data)
            xpos.take(bodies, 0, positions, "clip")
            xmat.take(bodies, 0, rotations, "clip")

    def give_back(self, row: int, ticks: int) -> None:
        """Set the state from before the last call in the world.

        Args:
            ticks: number of ticks that the world has missed until then.
        """
        world = self._worlds[row]
        assert world is not None
        mujoco.mj_setState(world.model, world.data, self.kernel.before[row], STATE)
        world.missed(ticks)
        kinematics.sync(world)


def _free_of(world: World) -> list[tuple[int, int]]:
    """The free bodies: the group, and the first of its positions in the engine."""
    slots = world.slots[: world.moving]
    return [(group, slot.qpos) for group, slot in enumerate(slots) if slot.frame.motion is Motion.FREE]
