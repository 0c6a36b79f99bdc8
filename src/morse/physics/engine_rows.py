"""The steps of the engine in many worlds at once, on several threads.

The states of the worlds are rows of one array, with which the engine steps them in one call. The worlds themselves do
not change meanwhile: `EngineRows.give_back` sets the state from before the last call in a world.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any
from weakref import WeakSet

import mujoco
import numpy as np
from mujoco.batch import Batch, SimulationError

from morse.kernel import threads
from morse.physics.model.layout import Motion
from morse.physics.model.placement import lowest_shape
from morse.physics.poses import kinematics
from morse.physics.poses.convert import RUNAWAY_DISTANCE, RUNAWAY_SPEED
from morse.physics.state.engine_values import STATE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.physics.world import World

#: a body that is so far below everything has left the world, which somebody reports, m
_BELOW = 5.0
#: share of the limits of positions and speeds; beyond it, the world itself finds out which body diverges
_NEAR = 0.5


_RESTING_AT_FORK: WeakSet[EngineRows] = WeakSet()


def _rest_all() -> None:
    for rows in list(_RESTING_AT_FORK):
        rows.rest()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_rest_all)


class EngineRows:
    """N worlds with models of the same sizes.

    Args:
        world: one of them.
        rows: N.

    Attributes:
        positions, rotations: (N, K, 3) m, (N, K, 9): poses of the rigid groups, which `place` updates.
        joints, speeds: (N, nq), (N, nv) positions and speeds of the joints, as the engine stores them.
        commands: (N, nu) commands of the motors.
    """

    def __init__(self, world: World, rows: int) -> None:
        groups = len(world.positions)
        self.positions, self.rotations = np.zeros((rows, groups, 3)), np.zeros((rows, groups, 9))
        self._models = [world.model] * rows
        #: of the engine; None until it is needed again, see `rest`
        self._batch: Batch | None = None
        self._state = np.zeros((rows, mujoco.mj_stateSize(world.model, STATE)))
        self._is_busy = False
        self._worlds: list[World | None] = [None] * rows
        #: model, data and arrays of each world, and where poses are written to
        self._poses: list[tuple[Any, ...]] = [()] * rows
        self._before = self._state.copy()
        #: steps of the engine in a tick, and the different numbers
        self._counts: set[int] = set()
        self._steps, self._moves = np.zeros(rows, np.int64), np.zeros((rows, groups), bool)
        #: free bodies: the group, and the first of its positions in the engine
        self._free: list[tuple[tuple[int, int], ...]] = [()] * rows
        #: which rows need the poses of these free bodies alone, or all poses (None)
        self._placed: dict[tuple[tuple[int, int], ...] | None, NDArray[np.bool_]] = {}
        self._falls = np.zeros((rows, groups), bool)
        self._most, self._lowest = np.zeros(rows, np.int64), np.zeros(rows)
        #: whether models have changed since the engine has taken note of them
        self._has_news = True
        self._wake()
        _RESTING_AT_FORK.add(self)

    def _wake(self) -> Batch:
        """Return what steps the engine; its threads begin if it rests."""
        batch = self._batch
        if batch is None:
            batch = self._batch = Batch(self._models[0], len(self._models), threads.count())
            batch.state[:] = self._state
            self.joints, self.commands = batch.bind("qpos"), batch.bind("ctrl")
            self.speeds, self._contacts = batch.bind("qvel"), batch.bind("ncon")
            self._has_news = True
        return batch

    def rest(self) -> None:
        """End the threads until the next call, because a process that is forked has none of them, and would wait."""
        if self._batch is not None and not self._is_busy:
            self._state[:] = self._batch.state
            # arrays of the engine would keep its threads
            self.joints = self.commands = self.speeds = self._contacts = np.zeros((0, 0))
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
        if self.positions[row, : world.moving, 2].min(initial=np.inf) < self._lowest[row]:
            return False
        mujoco.mj_getState(world.model, world.data, self._wake().state[row], STATE)
        return bool(poses)

    def _fits(self, row: int, world: World) -> bool:
        """Use another world, or another model of it; return whether its sizes are those of the others."""
        model, before = world.model, self._models[row]
        self._worlds[row], self._poses[row] = world, ()
        if len(world.positions) != self.positions.shape[1]:
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
        self._free[row] = tuple(
            (group, slot.qpos) for group, slot in enumerate(world.slots[:moving]) if slot.frame.motion is Motion.FREE
        )
        self._falls[row] = False
        self._falls[row, [group for group, _ in self._free[row]]] = True
        self._most[row], self._lowest[row] = world.most_contacts, lowest_shape(world)[0] - _BELOW
        return True

    def begin(self, going: NDArray[np.bool_]) -> None:
        """Begin a call of one or more ticks of some rows, (N,): `give_back` returns to this time."""
        batch = self._wake()
        if self._has_news:
            batch.set_models(self._models)
            self._has_news = False
        np.copyto(self._before, batch.state, where=going[:, None])

    def run(self, going: NDArray[np.bool_]) -> None:
        """Run a tick in some rows.

        Args:
            going: (N,) which ones; those in which something has happened that the world itself has to deal with are
                removed.
        """
        batch = self._wake()
        self._is_busy = True
        try:
            for count in self._counts:
                chosen = np.flatnonzero(going & (self._steps == count))
                try:
                    batch.step(chosen, count)
                except SimulationError:
                    batch.warning[chosen, 0, 1] += batch.status[chosen] != 0
        finally:
            self._is_busy = False
        speeds, places = self.speeds, self.joints
        going &= np.einsum("ij,ij->i", speeds, speeds) < (_NEAR * RUNAWAY_SPEED) ** 2
        going &= np.einsum("ij,ij->i", places, places) < (_NEAR * RUNAWAY_DISTANCE) ** 2
        going &= self._contacts <= self._most
        if batch.warning.any():
            going &= ~batch.warning[:, :, 1].any(axis=1)
            batch.warning[:] = 0

    def read(self, row: int, groups: Iterable[int] | None) -> None:
        """Say which poses of a row are needed.

        Args:
            groups: the rigid groups; None for all.
        """
        free, moving = self._free[row], np.count_nonzero(self._moves[row])
        needed = range(moving) if groups is None else [group for group in groups if group < moving]
        known = dict(free)
        for rows in self._placed.values():
            rows[row] = False
        roots = free if all(group in known for group in needed) else None
        self._placed.setdefault(roots, np.zeros(len(self._models), bool))[row] = True

    def place(self, going: NDArray[np.bool_]) -> None:
        """Compute the poses of some rows, (N,); those in which a body has fallen out of its world are removed."""
        for roots, placed in self._placed.items():
            rows = np.flatnonzero(going & placed)
            if roots is None:
                self._place_all(rows.tolist())
            elif len(rows):
                for group, place in roots:
                    self._place_free(rows, group, place)
        heights = np.where(self._falls, self.positions[:, :, 2], np.inf)
        going &= heights.min(axis=1, initial=np.inf) >= self._lowest

    def _place_free(self, rows: NDArray[np.int64], group: int, place: int) -> None:
        """Compute the poses of a free body from its positions in the engine, by the functions of `mj_kinematics`."""
        joints = self.joints[rows, place : place + 7]
        quaternions, rotations = joints[:, 3:].copy(), np.empty((len(rows), 9))
        for quaternion, rotation in zip(quaternions, rotations, strict=True):
            mujoco.mju_normalize4(quaternion)
            mujoco.mju_quat2Mat(rotation, quaternion)
        self.positions[rows, group], self.rotations[rows, group] = joints[:, :3], rotations

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
        mujoco.mj_setState(world.model, world.data, self._before[row], STATE)
        world.missed(ticks)
        kinematics.sync(world)
