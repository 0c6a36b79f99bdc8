"""Rows of a batch in which nothing happens but that motors move joints, and the engine everything.

Commands and setpoints are columns, and the engine steps all these rows in one call, on several threads. Their
simulations do not know of it. When somebody needs one, it gets the state from before the last step, and takes that step
itself, with the same commands: nothing differs from a simulation alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.joints import Motors
from morse.physics.engine_rows import EngineRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.actuator import Actuator
    from morse.core.rows.columns import Setpoints
    from morse.kernel.joints import JointRows
    from morse.many.batched_step import Command
    from morse.many.fields import CommandColumn
    from morse.many.readings import Reading
    from morse.simulation.simulation import Simulation


class JointedRows:
    """See `morse.many.batched_step.RowsAlike`.

    Args:
        commands: the columns of commands, also those that are added later.
    """

    has_engine = True

    def __init__(self, simulations: Sequence[Simulation], commands: Sequence[CommandColumn]) -> None:
        self._simulations, self._commands = simulations, commands
        self.members = np.zeros(len(simulations), bool)
        self._drives: dict[str, _Drive] = {}
        self._engine: EngineRows | None = None

    @property
    def states(self) -> EngineRows:
        """The poses, and the states of the engine."""
        assert self._engine is not None
        return self._engine

    def add(self, row: int, readings: Sequence[Reading]) -> bool:
        """Take the state of a simulation, if nothing can happen in its next ticks but that motors move joints."""
        simulation = self._simulations[row]
        moved = simulation.moved_joints()
        # the engine takes no worlds whose bodies sleep
        if moved is None or not simulation.world.only_steps():
            return False
        engine = self._engine
        if engine is None:
            engine = self._engine = EngineRows(simulation.world, len(self.members))
            self._drives = {actuator.name(): _Drive(engine.kernel, one) for actuator, one in moved}
        if len(moved) != len(self._drives) or not engine.add(row, simulation.world):
            return False
        for actuator, setpoints in moved:
            drive = self._drives.get(actuator.name())
            if drive is None or not drive.add(row, actuator, setpoints):
                return False
        clock, kernel = simulation.clock, engine.kernel
        kernel.ticks[row], kernel.rates[row], kernel.origins[row] = clock.tick, clock.frequency, clock.origin
        kernel.missed[row] = kernel.last[row] = 0
        if not all(reading.add(row, simulation, engine) for reading in readings):
            return False
        groups = [reading.groups(row) for reading in readings]
        engine.read(row, None if None in groups else {group for some in groups for group in some or ()})
        return True

    def stop(self, row: int) -> None:
        """Let a simulation be as it was before the last step, with the commands of this step."""
        simulation, missed = self._simulations[row], int(self.states.kernel.missed[row])
        self.states.give_back(row, missed)
        simulation.missed(missed)
        for drive in self._drives.values():
            drive.give_back(row)
        for column in self._commands:
            column.repeat(row)

    def leave(self, row: int) -> None:
        """Let a simulation take the last step itself; it measures at its end, as the member has."""
        if last := int(self.states.kernel.last[row]):
            self.stop(row)
            self._simulations[row].step(last, measure=True)

    # -- a step ------------------------------------------------------------------------------

    def run(self, ticks: int, commands: Sequence[Command]) -> NDArray[np.int64]:
        """Run ticks of the members; where something has to happen that the world itself deals with, there are none."""
        engine = self.states
        going, motors = engine.kernel.going, [drive.motors for drive in self._drives.values()]
        going[:] = self.members
        engine.begin(ticks)
        for one in motors:
            one.begin()
        is_whole = np.count_nonzero(self.members) == len(going)
        for column, rows in commands:
            told = rows if is_whole else rows[self.members[rows]]
            if len(told):
                self._drives[column.name].tell(column, told)
        for left in range(ticks - 1, -1, -1):
            for one in motors:
                one.act()
            engine.run(is_last=not left)
        engine.place(ticks)
        return np.where(going, ticks, 0)

    def times(self, rows: NDArray[np.intp]) -> NDArray[np.float64]:
        """The times of members, s."""
        return self.states.kernel.times[rows]


class _Drive:
    """The setpoints of an actuator in all rows: see `morse.core.rows.columns.Setpoints`."""

    def __init__(self, kernel: JointRows, setpoints: Setpoints) -> None:
        self._fields = tuple(setpoints.fields)
        self.motors = Motors(kernel, len(self._fields))
        self._actuators: list[Actuator | None] = [None] * len(kernel.going)
        #: numbers of the fields of commands
        self._numbers: dict[tuple[str, ...], NDArray[np.int64]] = {}

    def add(self, row: int, actuator: Actuator, setpoints: Setpoints) -> bool:
        """Take the setpoints of a row; return whether they are numbers of the same joints."""
        if tuple(setpoints.fields) != self._fields:
            return False
        data, motors = actuator.local_data, self.motors
        try:
            motors.targets[row] = [float(data[name]) for name in self._fields]
        except (KeyError, TypeError, ValueError):  # its action tells
            return False
        motors.values[row], motors.steps[row], motors.channels[row] = (
            setpoints.values,
            setpoints.steps,
            setpoints.channels,
        )
        motors.low[row], motors.high[row] = zip(*setpoints.bounds, strict=True)
        self._actuators[row] = actuator
        motors.limit(row)
        return not np.isnan(motors.targets[row]).any()

    def give_back(self, row: int) -> None:
        """Give the actuator of a row its setpoints from before the last step."""
        actuator = self._actuators[row]
        assert actuator is not None
        actuator.local_data.update(zip(self._fields, self.motors.targets_before[row].tolist(), strict=True))
        actuator.went_on(self.motors.values_before[row].tolist())

    def tell(self, column: CommandColumn, rows: NDArray[np.intp]) -> None:
        """Take the commands of some rows."""
        fields = tuple(column.layout.fields)
        numbers = self._numbers.get(fields)
        if numbers is None:
            numbers = self._numbers[fields] = np.array([self._fields.index(name) for name in fields], np.int64)
        self.motors.tell(rows, numbers, column.take(rows))
