"""Rows of a batch in which nothing happens but that robots glide, far from everything.

The kernel runs the ticks of all these rows in one call. Their simulations are told later how many there were.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.batched import Courses

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.many.batched_step import Command
    from morse.many.readings import Reading
    from morse.simulation.simulation import Simulation

#: smallest number of rows for which arrays pay
_LEAST = 2


class GlidingRows:
    """See `morse.many.batched_step.RowsAlike`."""

    has_engine = False

    def __init__(self, simulations: Sequence[Simulation]) -> None:
        count = len(simulations)
        self._simulations = simulations
        self.members = np.zeros(count, bool)
        #: ticks that a simulation does not know of; and ticks that are certainly free
        self._owed, self._left = np.zeros(count, np.int64), np.zeros(count, np.int64)
        self._courses: Courses | None = None

    @property
    def states(self) -> Courses:
        """The poses."""
        assert self._courses is not None
        return self._courses

    def add(self, row: int, readings: Sequence[Reading]) -> bool:
        """Take the state of a simulation, if nothing can happen in its next ticks but that robots glide."""
        simulation, count = self._simulations[row], len(self.members)
        if count < _LEAST or not simulation.coasts:
            return False
        world = simulation.world
        course = world.free_run.course() if simulation.obey() else None
        world.drives.clear()
        if course is None:
            return False
        groups = len(world.positions)
        if self._courses is None:
            self._courses = Courses(count, groups)
        courses = self._courses
        if courses.positions.shape[1] != groups:
            return False
        courses.positions[row], courses.rotations[row] = world.positions.array, world.rotations.array
        courses.set(row, course)
        self._owed[row] = self._left[row] = 0
        return all(reading.add(row, simulation, courses) for reading in readings)

    def stop(self, row: int) -> None:
        """Let the world and the clock of a simulation take note of the ticks; its sensors measure after the rest."""
        self._note(row, measured=False)

    def leave(self, row: int) -> None:
        """Let a simulation take note of the ticks; its sensors measure."""
        self._note(row, measured=True)

    def _note(self, row: int, *, measured: bool) -> None:
        ticks, self._owed[row] = int(self._owed[row]), 0
        if ticks:
            self._simulations[row].world.free_run.ran(ticks)
            self._simulations[row].coasted(ticks, measured=measured)

    # -- a step ------------------------------------------------------------------------------

    def run(self, ticks: int, commands: Sequence[Command]) -> NDArray[np.int64]:
        """Run ticks of the members; robots whose commands have changed take them first."""
        ran, goes_on = np.zeros(len(self.members), np.int64), self.members.copy()
        for row in self._obeying(commands):
            self._note(row, measured=False)
            goes_on[row] = self._simulations[row].obey()
            if goes_on[row]:
                self._simulations[row].world.drives.clear()
        rows = np.flatnonzero(goes_on)
        for row in rows[self._left[rows] < ticks].tolist():
            self._left[row] = self._simulations[row].world.free_run.ahead(ticks, int(self._owed[row]))
        near = self._left[rows] < ticks
        self._go(rows[~near], ticks, ran)
        for row in rows[near].tolist():
            self._go_near(row, ticks, ran)
        return ran

    def _obeying(self, commands: Sequence[Command]) -> list[int]:
        """Give changed commands to the actuators of their rows; return these rows."""
        changed = np.zeros(len(self.members), bool)
        for column, _ in commands:
            changed |= self.members & column.changes()
        if changed.any():
            for column, rows in commands:
                column.publish(rows[changed[rows]])
        return np.flatnonzero(changed).tolist()

    def _go(self, rows: NDArray[np.intp], ticks: int, ran: NDArray[np.int64]) -> None:
        """Run ticks of rows, in which nothing is touched."""
        if len(rows):
            done = self.states.run(rows, ticks)
            ran[rows] += done
            self._owed[rows] += done
            self._left[rows] -= done

    def _go_near(self, row: int, ticks: int, ran: NDArray[np.int64]) -> None:
        """Run ticks of a row as long as nothing is so near that it could be touched in the next tick."""
        free_run, rows = self._simulations[row].world.free_run, np.array([row])
        while ran[row] < ticks and self._left[row]:
            before, count = ran[row], min(self._left[row], ticks - ran[row])
            self._go(rows, count, ran)
            if ran[row] - before < count:
                return
            self._left[row] = free_run.ahead(int(ticks - ran[row]), int(self._owed[row])) if ran[row] < ticks else 0

    def times(self, rows: NDArray[np.intp]) -> NDArray[np.float64]:
        """The times of members, s."""
        clocks = [self._simulations[row].clock for row in rows.tolist()]
        owed = self._owed[rows].tolist()
        return np.array(
            [one.origin + (one.tick + more) / one.frequency for one, more in zip(clocks, owed, strict=True)]
        )
