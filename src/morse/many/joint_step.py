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
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.core.actuator import Actuator
    from morse.core.rows.columns import Setpoints
    from morse.kernel.joints import JointRows
    from morse.many.batched_step import Reading
    from morse.many.fields import CommandColumn
    from morse.simulation.simulation import Simulation

    #: a column, and the rows that have a command
    Command = tuple[CommandColumn, NDArray[np.intp]]


class JointStep:
    """The rows in which only joints move.

    Args:
        commands: the columns of commands, also those that are added later.
        readings: the same for data.

    Attributes:
        members: (N,) which rows these are.
        count: their number.
    """

    def __init__(
        self, simulations: Sequence[Simulation], commands: Sequence[CommandColumn], readings: Sequence[Reading]
    ) -> None:
        count = len(simulations)
        self._simulations, self._commands, self._readings = simulations, commands, readings
        self.members, self.count = np.zeros(count, bool), 0
        self._drives: dict[str, _Drive] = {}
        self._engine: EngineRows | None = None

    # -- who is a member -----------------------------------------------------------------------

    def join(self, row: int) -> bool:
        """Let a row be a member, if nothing else can happen in it."""
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
        if not all(reading.add(row, simulation, engine) for reading in self._readings):
            return False
        groups = [reading.groups(row) for reading in self._readings]
        engine.read(row, None if None in groups else {group for some in groups for group in some or ()})
        self.members[row] = True
        self.count += 1
        return True

    def leave(self, row: int) -> None:
        """Bring the simulation of a row up to date; it measures at the end of the last step, as the member has."""
        if not self.members[row]:
            return
        self._remove(row)
        assert self._engine is not None
        if last := int(self._engine.kernel.last[row]):
            self._return(row)
            for column in self._commands:
                column.repeat(row)
            self._simulations[row].step(last, measure=True)

    def drop(self, row: int) -> None:
        """Forget what a row has done, because its simulation begins anew."""
        if self.members[row]:
            self._remove(row)

    def _remove(self, row: int) -> None:
        self.members[row] = False
        self.count -= 1

    def _return(self, row: int) -> None:
        """Let a simulation be as it was before the last step."""
        assert self._engine is not None
        simulation, missed = self._simulations[row], int(self._engine.kernel.missed[row])
        self._engine.give_back(row, missed)
        simulation.missed(missed)
        for drive in self._drives.values():
            drive.give_back(row)

    # -- a step ------------------------------------------------------------------------------

    def run(self, ticks: int, commands: Iterable[Command]) -> NDArray[np.int64]:
        """Run a step of the members, at whose end all sensors measure.

        Returns:
            (N,) the numbers of ticks. Members for which it is 0 have left: their simulations are as before the step,
            and have the commands of the step.
        """
        engine = self._engine
        if engine is None or not self.count:
            return np.zeros(len(self.members), np.int64)
        kernel = engine.kernel
        going, motors = kernel.going, [drive.motors for drive in self._drives.values()]
        going[:] = self.members
        engine.begin(ticks)
        for one in motors:
            one.begin()
        is_whole = self.count == len(going)
        told = [(column, numbers if is_whole else numbers[going[numbers]]) for column, numbers in commands]
        for column, numbers in told:
            if len(numbers):
                self._drives[column.name].tell(column, numbers)
        for left in range(ticks - 1, -1, -1):
            for one in motors:
                one.act()
            engine.run(is_last=not left)
        engine.place(ticks)
        rows = np.flatnonzero(going)
        if len(rows) < self.count:
            for row in np.flatnonzero(self.members & ~going).tolist():
                self._remove(row)
                self._return(row)
                for column, numbers in told:
                    column.publish(numbers[numbers == row])
        if len(rows):
            for reading in self._readings:
                reading.update(rows, engine, kernel.times[rows])
        return np.where(going, ticks, 0)


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
