"""Rows of a batch that go on together, because little happens in them: robots glide, or motors move joints.

The kernel or the engine runs the ticks of all these rows in one call, and their data are computed for all at once: the
same functions in the same order as in single simulations. Their simulations do not know of these ticks until somebody
needs them. A row whose simulation was handed out is never among them, because then somebody may look at any time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.many.gliding_rows import GlidingRows
from morse.many.jointed_rows import JointedRows
from morse.many.readings import reading_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.many.fields import CommandColumn, DataColumn
    from morse.many.readings import Reading, States
    from morse.simulation.simulation import Simulation

    #: a column, and the rows that have a command
    Command = tuple[CommandColumn, NDArray[np.intp]]


class RowsAlike(Protocol):
    """N rows of which those go on together in which the same kind of thing happens.

    Attributes:
        members: (N,) which rows these are; the owner of this object sets it.
        has_engine: whether the engine moves the rows; else they have no data of the engine.
    """

    members: NDArray[np.bool_]
    has_engine: bool

    @property
    def states(self) -> States:
        """The poses after a call of `run`."""
        ...

    def add(self, row: int, readings: Sequence[Reading]) -> bool:
        """Take the state of a simulation; return False if something else may happen in its next ticks."""
        ...

    def run(self, ticks: int, commands: Sequence[Command]) -> NDArray[np.int64]:
        """Run ticks of the members with commands; return how many (N,): fewer where something else has to happen."""
        ...

    def times(self, rows: NDArray[np.intp]) -> NDArray[np.float64]:
        """The times of members after `run`, s."""
        ...

    def stop(self, row: int) -> None:
        """Let the simulation of a row, of which `run` has run fewer ticks, be where it takes over."""
        ...

    def leave(self, row: int) -> None:
        """Let the simulation of a row be as after the last step, at whose end all of its sensors have measured."""
        ...


class BatchedStep:
    """The rows that go on together.

    Args:
        commands: the columns of commands, also those that are added later.
    """

    def __init__(self, simulations: Sequence[Simulation], commands: Sequence[CommandColumn]) -> None:
        count = len(simulations)
        self._kinds: list[RowsAlike] = [GlidingRows(simulations), JointedRows(simulations, commands)]
        self._possible = list(self._kinds)
        #: the rows that are stepped by their simulations; those that were handed out; those that have just begun
        self._apart, self._public = np.ones(count, bool), np.zeros(count, bool)
        self._fresh = set(range(count))
        #: the members of each kind
        self._numbers: list[tuple[RowsAlike, NDArray[np.intp]]] = []
        self._numbers_apart: list[int] = []
        self._has_moved = True
        self._readings: list[Reading] = []

    def read(self, column: DataColumn) -> None:
        """Take note of data that are read after each step."""
        for row in range(len(self._apart)):
            self.leave(row)
        reading = reading_of(column)
        if reading is None:
            self._possible = []
        else:
            self._readings.append(reading)
            self._possible = [kind for kind in self._possible if kind.has_engine or not reading.needs_engine]

    def publish(self, rows: Iterable[int]) -> None:
        """Take note of simulations that are handed out."""
        for row in rows:
            self.leave(row)
            self._public[row] = True

    # -- who is a member -----------------------------------------------------------------------

    def renew(self, rows: Iterable[int]) -> None:
        """Take note of simulations that have begun anew: they may go on together from their next step on."""
        self._fresh.update(rows)

    def join(self, rows: Iterable[int]) -> None:
        """Let those rows go on together in whose next steps little can happen."""
        for row in rows:
            if self._public[row] or not self._apart[row]:
                continue
            for kind in self._possible:
                if kind.add(row, self._readings):
                    self._move(row, kind, joins=True)
                    break

    def leave(self, row: int) -> None:
        """Bring the simulation of a row up to date."""
        if kind := self._remove(row):
            kind.leave(row)

    def drop(self, row: int) -> None:
        """Forget what a row has done, because its simulation begins anew."""
        self._remove(row)

    def _remove(self, row: int) -> RowsAlike | None:
        if not self._apart[row]:
            for kind in self._kinds:
                if kind.members[row]:
                    self._move(row, kind, joins=False)
                    return kind
        return None

    def _move(self, row: int, kind: RowsAlike, *, joins: bool) -> None:
        kind.members[row], self._apart[row] = joins, not joins
        self._has_moved = True

    def _look(self) -> None:
        """Take note of who is where."""
        if self._has_moved:
            self._numbers = [(one, np.flatnonzero(one.members)) for one in self._kinds if one.members.any()]
            self._numbers_apart, self._has_moved = np.flatnonzero(self._apart).tolist(), False

    @property
    def apart(self) -> list[int]:
        """The rows that are stepped by their simulations."""
        self._look()
        return self._numbers_apart

    # -- a step ------------------------------------------------------------------------------

    def run(self, ticks: int, commands: Sequence[Command]) -> NDArray[np.int64]:
        """Run a step, at whose end all sensors measure, of the rows that go on together.

        The other rows get their commands. Without ticks, commands of rows that go on together wait in their array.

        Returns:
            (N,) the numbers of ticks; the simulations of rows with fewer ticks are up to date.
        """
        if ticks and self._fresh:
            fresh, self._fresh = sorted(self._fresh), set()
            self.join(fresh)
        if self.apart:
            for column, rows in commands:
                column.publish(rows[self._apart[rows]])
        every = np.zeros(len(self._apart), np.int64)
        for kind, members in self._numbers if ticks else ():
            ran = kind.run(ticks, commands)
            every += ran
            rows = members
            if np.count_nonzero(ran == ticks) < len(members):
                rows = members[ran[members] == ticks]
                for row in members[ran[members] < ticks].tolist():
                    self._remove(row)
                    kind.stop(row)
            if len(rows):
                times = kind.times(rows)
                for reading in self._readings:
                    reading.update(rows, kind.states, times)
        return every
