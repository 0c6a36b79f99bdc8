"""Rows of a batch in which nothing happens but that motors move joints, and the engine everything.

Commands and setpoints are columns, and the engine steps all these rows in one call, on several threads. Their
simulations do not know of it. When somebody needs one, it gets the state from before the last step, and takes that step
itself, with the same commands: nothing differs from a simulation alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.engine_rows import EngineRows

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.core.actuator import Actuator
    from morse.core.rows.columns import Setpoints
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
    """

    def __init__(
        self, simulations: Sequence[Simulation], commands: Sequence[CommandColumn], readings: Sequence[Reading]
    ) -> None:
        count = len(simulations)
        self._simulations, self._commands, self._readings = simulations, commands, readings
        self.members = np.zeros(count, bool)
        #: ticks that a simulation does not know of, without those of the last step; and those
        self._missed, self._last = np.zeros(count, np.int64), np.zeros(count, np.int64)
        #: number of ticks that a simulation knows of, their rate in Hz, and the time of the first one, s
        self._ticks, self._rates, self._origins = np.zeros(count, np.int64), np.ones(count), np.zeros(count)
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
            self._drives = {actuator.name(): _Drive(len(self.members), one) for actuator, one in moved}
        if len(moved) != len(self._drives) or not engine.add(row, simulation.world):
            return False
        for actuator, setpoints in moved:
            drive = self._drives.get(actuator.name())
            if drive is None or not drive.add(row, actuator, setpoints):
                return False
        clock = simulation.clock
        self._ticks[row], self._rates[row], self._origins[row] = clock.tick, clock.frequency, clock.origin
        self._missed[row] = self._last[row] = 0
        if not all(reading.add(row, simulation, engine) for reading in self._readings):
            return False
        groups = [reading.groups(row) for reading in self._readings]
        engine.read(row, None if None in groups else {group for some in groups for group in some or ()})
        self.members[row] = True
        return True

    def leave(self, row: int) -> None:
        """Bring the simulation of a row up to date; it measures at the end of the last step, as the member has."""
        if not self.members[row]:
            return
        self.members[row] = False
        if self._last[row]:
            self._return(row)
            for column in self._commands:
                column.repeat(row)
            self._simulations[row].step(int(self._last[row]), measure=True)

    def drop(self, row: int) -> None:
        """Forget what a row has done, because its simulation begins anew."""
        self.members[row] = False

    def _return(self, row: int) -> None:
        """Let a simulation be as it was before the last step."""
        assert self._engine is not None
        simulation, missed = self._simulations[row], int(self._missed[row])
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
        going, engine = self.members.copy(), self._engine
        if engine is None or not going.any():
            return np.zeros(len(going), np.int64)
        self._missed += np.where(going, self._last, 0)
        self._last[going] = ticks
        engine.begin(going)
        drives = self._drives.values()
        for drive in drives:
            drive.begin(going)
        told = [(column, numbers[going[numbers]]) for column, numbers in commands]
        for column, numbers in told:
            if len(numbers):
                self._drives[column.name].tell(numbers, column.layout.fields, column.take(numbers))
        for _ in range(ticks):
            for drive in drives:
                drive.act(going, engine.commands)
            engine.run(going)
        engine.place(going)
        if not np.array_equal(going, self.members):
            for row in np.flatnonzero(self.members & ~going).tolist():
                self.members[row] = False
                self._return(row)
                for column, numbers in told:
                    column.publish(numbers[numbers == row])
        rows = np.flatnonzero(going)
        if len(rows):
            times = self._origins[rows] + (self._ticks[rows] + self._missed[rows] + ticks) / self._rates[rows]
            for reading in self._readings:
                reading.update(rows, engine, times)
        return np.where(going, ticks, 0)


class _Drive:
    """The setpoints of an actuator in all rows, (N, J) each: see `morse.core.rows.columns.Setpoints`."""

    def __init__(self, rows: int, setpoints: Setpoints) -> None:
        self._fields = tuple(setpoints.fields)
        self._places = {name: place for place, name in enumerate(self._fields)}
        shape = rows, len(self._fields)
        self._targets, self._values, self._low, self._high = (np.zeros(shape) for _ in range(4))
        #: the targets within the limits; what a tick changes at most, and whether that is a limit
        self._goals, self._steps, self._has_limit = np.zeros(shape), np.full(shape, np.inf), False
        self._targets_before, self._values_before = np.zeros(shape), np.zeros(shape)
        self._channels = np.zeros(shape, np.intp)
        self._actuators: list[Actuator | None] = [None] * rows

    def add(self, row: int, actuator: Actuator, setpoints: Setpoints) -> bool:
        """Take the setpoints of a row; return whether they are numbers of the same joints."""
        if tuple(setpoints.fields) != self._fields:
            return False
        data = actuator.local_data
        try:
            self._targets[row] = [float(data[name]) for name in self._fields]
        except (KeyError, TypeError, ValueError):  # its action tells
            return False
        self._values[row], self._steps[row], self._channels[row] = (
            setpoints.values,
            setpoints.steps,
            setpoints.channels,
        )
        self._low[row], self._high[row] = zip(*setpoints.bounds, strict=True)
        self._has_limit |= bool((self._steps[row] < np.inf).any())
        self._actuators[row] = actuator
        self._limit(np.array([row]))
        return not np.isnan(self._targets[row]).any()

    def begin(self, going: NDArray[np.bool_]) -> None:
        """Begin a step of some rows: `give_back` returns to this time."""
        np.copyto(self._targets_before, self._targets, where=going[:, None])
        np.copyto(self._values_before, self._values, where=going[:, None])

    def give_back(self, row: int) -> None:
        """Give the actuator of a row its setpoints from before the last step."""
        actuator = self._actuators[row]
        assert actuator is not None
        actuator.local_data.update(zip(self._fields, self._targets_before[row].tolist(), strict=True))
        actuator.went_on(self._values_before[row].tolist())

    def tell(self, rows: NDArray[np.intp], fields: Sequence[str], values: NDArray[np.float64]) -> None:
        """Take commands (M, F) of M rows."""
        if tuple(fields) == self._fields:
            self._targets[rows] = values
        else:
            self._targets[rows[:, None], [self._places[name] for name in fields]] = values
        self._limit(rows)

    def _limit(self, rows: NDArray[np.intp]) -> None:
        goal, low, high = self._targets[rows], self._low[rows], self._high[rows]
        self._goals[rows] = np.where(goal < low, low, np.where(goal > high, high, goal))

    def act(self, going: NDArray[np.bool_], commands: NDArray[np.float64]) -> None:
        """Move the joints of some rows toward their setpoints by one tick, and write the commands (N, nu)."""
        here, new = self._values, self._goals
        differs = (new != here) & going[:, None]
        if not differs.any():
            return
        moves = differs
        if self._has_limit:
            step, way = self._steps, new - here
            # what has no limit goes to its setpoint, so that no infinite number remains
            new = np.where((-step <= way) & (way <= step), new, np.where(way > 0.0, here + step, here - step))
            moves = differs & (new != here)
        rows, joints = np.nonzero(moves & (self._channels >= 0))
        commands[rows, self._channels[rows, joints]] = new[rows, joints]
        np.copyto(here, new, where=differs.any(axis=1, keepdims=True))
