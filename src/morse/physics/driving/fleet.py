"""Bodies and wheels that are driven together, with one call per tick."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.driving import GliderArrays, gliders
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.driving import GliderWork
    from morse.physics.driving.command import Command
    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.state.engine_state import EngineState


class Fleet:
    """Bodies whose velocities in the plane of their X and Y axes are commanded in the same ticks.

    The command of each body lasts until `adopt` replaces it. The velocities of robots that glide, and of robots that
    push something, are written in one call each. `Drives` handles the others one by one: robots that start, stop, or
    have friction.

    Attributes:
        rows: row of each slot.
    """

    def __init__(self, drives: Drives, slots: Sequence[int]) -> None:
        self._drives = drives
        self._slots = np.array(slots, dtype=np.int64)
        self.rows = {slot: row for row, slot in enumerate(slots)}
        count = len(slots)
        self._forward, self._aside, self._rate = np.zeros(count), np.zeros(count), np.zeros(count)
        self._shifts = np.zeros(count, dtype=np.uint8)
        self._ground = np.zeros(count, dtype=np.uint8)
        self._others = np.zeros(count, dtype=np.int64)
        self._settled = np.zeros(count, dtype=np.int64)
        self._settled_count = 0
        self._commands: list[Command | None] = [None] * count
        self._withdrawn: set[int] = set()
        self._work: GliderWork | None = None
        self._state: EngineState | None = None

    def adopt(self, row: int) -> bool:
        """Make the present command of a body last: the command of `Drives` for the next tick.

        Returns:
            False if the body has no command, or one that does not keep it in the plane of its X and Y axes.
        """
        slot = int(self._slots[row])
        command = self._drives.command_of(slot)
        if command is None or command.linear[2] or command.angular[0] or command.angular[1]:
            return False
        self._commands[row] = command
        self._forward[row], self._aside[row], _ = command.linear
        self._rate[row] = command.angular[2]
        self._shifts[row], self._ground[row] = command.shift, command.ground
        return True

    def drive(self) -> None:
        """Drive the bodies in the next tick."""
        self._drives.command_fleet(self)

    def renew(self) -> None:
        """Use the commands of all bodies again, also of those that `withdraw` removed."""
        self._withdrawn.clear()

    def withdraw(self, slot: int) -> None:
        """Remove the command of one slot, because the slot gets no command, or a command from another caller."""
        self._withdrawn.add(self.rows[slot])

    @property
    def is_partial(self) -> bool:
        """Whether commands of some bodies were removed."""
        return bool(self._withdrawn)

    def work_of(self, state: EngineState) -> GliderWork | None:
        """Return what drives the robots of a world; None if they were not driven before."""
        return self._work if self._state is state else None

    def commands(self) -> dict[int, Command]:
        """Return the commands as single commands, by slot."""
        return {
            slot: command
            for slot, row in self.rows.items()
            if row not in self._withdrawn and (command := self._commands[row]) is not None
        }

    def begin(
        self,
        state: EngineState,
        gliding: Gliding,
        plain: NDArray[np.uint8],
        sliding: NDArray[np.uint8],
    ) -> dict[int, Command]:
        """Write the velocities of most robots at the beginning of a tick.

        Args:
            plain, sliding: (K,) rows; see `GliderArrays`.

        Returns:
            The commands of the other robots, by slot.
        """
        if self._work is None or self._state is not state:
            self._work, self._state = gliders(self._arrays(state, gliding, plain, sliding)), state
        velocities = plain[self._slots[list(self._withdrawn)]] if self._withdrawn else None
        if velocities is not None:
            plain[self._slots[list(self._withdrawn)]] = 0
        count, self._settled_count = self._work.begin(state.rotations.array), 0
        if count:
            count = self._push(self._work, state, gliding, count)
        if velocities is not None:
            plain[self._slots[list(self._withdrawn)]] = velocities
        if not count:
            return {}
        rows = [row for row in self._others[:count].tolist() if row not in self._withdrawn]
        return {int(self._slots[row]): self._commands[row] for row in rows}

    def _push(self, work: GliderWork, state: EngineState, gliding: Gliding, count: int) -> int:
        """Write the velocities of the robots that do not glide; return how many remain to be driven one by one."""
        remaining, self._settled_count = work.push(state.positions.array, state.rotations.array, count, gliding.tick)
        if remaining < count:
            state.is_stirred = True
        return remaining

    def settle(self, gliding: Gliding) -> None:
        """Let the robots glide that have settled, after `begin`."""
        for row in self._settled[: self._settled_count].tolist():
            gliding.consider_settled(int(self._slots[row]), self._commands[row])

    def end(self) -> None:
        """Called at the end of a tick."""
        if self._work is not None:
            self._work.end()

    def _arrays(
        self, state: EngineState, gliding: Gliding, plain: NDArray[np.uint8], sliding: NDArray[np.uint8]
    ) -> GliderArrays:
        count, slots = len(self._slots), state.slots
        trees = [int(state.model.body_treeid[slot.body]) if slot.dof >= 0 else -1 for slot in slots]
        return GliderArrays(
            slots=self._slots,
            forward=self._forward,
            aside=self._aside,
            rate=self._rate,
            shifts=self._shifts,
            ground=self._ground,
            dofs=np.array([slot.dof for slot in slots], dtype=np.int64),
            speeds=gliding.speeds,
            margins=gliding.margins,
            extents=gliding.extents,
            plain=plain,
            free=np.array([slot.frame.motion is Motion.FREE and slot.dof >= 0 for slot in slots], dtype=np.uint8),
            sliding=sliding,
            trees=np.array(trees, dtype=np.int32),
            asleep=state.data.tree_asleep,
            velocities=state.data.qvel,
            period=state.period,
            done=np.zeros(count, dtype=np.uint8),
            cosines=np.ones(count),
            sines=np.zeros(count),
            others=self._others,
            settled=self._settled,
            stances=gliding.stances.arrays,
        )


class WheelFleet:
    """Robots on driven wheels; the speeds of the wheels of each robot last until `adopt` replaces them."""

    def __init__(self, state: EngineState, slots: Sequence[int]) -> None:
        motors = [[state.slots[wheel].actuator for wheel in state.wheels.get(slot, ())] for slot in slots]
        self._motors = np.array([motor for one in motors for motor in one], dtype=np.int64)
        self._ends = list(accumulate(map(len, motors), initial=0))
        self._controls = state.data.ctrl
        self._speeds = np.zeros(len(self._motors))

    def adopt(self, row: int) -> bool:
        """Make the present speeds of the wheels of a robot last; return False if it has no driven wheels."""
        part = slice(self._ends[row], self._ends[row + 1])
        self._speeds[part] = self._controls[self._motors[part]]
        return part.start < part.stop

    def drive(self) -> None:
        """Turn all wheels at their speeds in the next tick, also those that were set to other speeds since."""
        self._controls[self._motors] = self._speeds
