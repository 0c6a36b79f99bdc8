"""Rows of a batch that go on together: nothing happens in them but that robots glide, far from everything.

The kernel runs the ticks and the scans of all these rows in one call: the same functions in the same order as in single
simulations. Their simulations do not know of these ticks until somebody needs them. A row whose simulation was handed
out is never among them, because then somebody may look at any time. Rows in which the engine moves robots with joints
go on together by `morse.many.joint_step`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.rows.columns import columns_of
from morse.core.rows.rows import SensorRows
from morse.kernel.batched import Courses, Lanes
from morse.kernel.joints import Gathered
from morse.kernel.rays import Hits
from morse.many.joint_step import JointStep
from morse.mathutils.rotations import turn, turn_back
from morse.physics.engine_rows import EngineRows
from morse.physics.poses.snapshot import Mountings, PoseRows, Snapshot
from morse.physics.rays.bundle import RayBundle, Scan, Sight

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.many.fields import CommandColumn, DataColumn
    from morse.many.joint_step import Command
    from morse.physics.poses.snapshot import Numbers
    from morse.simulation.simulation import Simulation


_FIRST = np.zeros(1, np.intp)
#: smallest number of rows for which arrays pay, of rows that glide
_LEAST = 2
#: number of rows of which numbers take less time than arrays
_FEW = 8
#: the field of all sensors with the time of the measurement
_TIME = "timestamp"


class BatchedStep:
    """The rows that go on together.

    Args:
        commands: the columns of commands, also those that are added later.

    Attributes:
        members: (N,) which rows these are, without those of `joint_step`.
        joint_step: the rows in which only joints move.
    """

    def __init__(self, simulations: Sequence[Simulation], commands: Sequence[CommandColumn]) -> None:
        count = len(simulations)
        self._simulations = simulations
        self.members = np.zeros(count, bool)
        self._public = np.zeros(count, bool)
        #: ticks that a simulation does not know of; and ticks that are certainly free
        self._owed, self._left = np.zeros(count, np.int64), np.zeros(count, np.int64)
        self._columns: list[Reading] = []
        self._courses: Courses | None = None
        self._is_possible = count >= _LEAST
        self.joint_step = JointStep(simulations, commands, self._columns)
        #: rows that may be members of `joint_step` from their next step on, and whether all data can be read of them
        self._fresh, self._has_columns = set(range(count)), True

    def read(self, column: DataColumn) -> None:
        """Take note of data that are read after each step."""
        for row in np.flatnonzero(self.joint_step.members).tolist():
            self.leave(row)
        self._columns.append(Reading(column, len(self.members)))
        self._is_possible &= self._columns[-1].is_possible
        self._has_columns &= self._columns[-1].has_columns

    def publish(self, rows: Iterable[int]) -> None:
        """Take note of simulations that are handed out."""
        for row in rows:
            self.leave(row)
            self._public[row] = True

    def renew(self, rows: Iterable[int]) -> None:
        """Take note of simulations that have begun anew."""
        self._fresh.update(rows)

    # -- a step ------------------------------------------------------------------------------

    @property
    def is_empty(self) -> bool:
        """Whether no row goes on together with others."""
        return not (self.joint_step.count or self.members.any())

    @property
    def has_only_joints(self) -> bool:
        """Whether all rows go on together because only joints move in them."""
        return self.joint_step.count == len(self.members)

    def begin(self) -> None:
        """Let those rows be members of `joint_step` that may be from the first step on."""
        if self._fresh:
            rows, self._fresh = sorted(self._fresh), set()
            for row in rows:
                self._join_joints(row)

    def _join_joints(self, row: int) -> bool:
        return self._has_columns and not (self._public[row] or self.members[row]) and self.joint_step.join(row)

    def run(self, ticks: int, commanded: NDArray[np.bool_], commands: Sequence[Command]) -> NDArray[np.int64]:
        """Run a step of the members, at whose end all sensors measure.

        Args:
            commanded: (N,) members with another command than before, which their simulations have.
            commands: the commands of `joint_step`, see there.

        Returns:
            (N,) the numbers of ticks; the simulations of the other rows, and of those with fewer ticks, are up to date.
        """
        ran = self.joint_step.run(ticks, commands)
        if not self.members.any():
            return ran
        # whoever leaves is stepped next, so that its sensors measure at the end of that step
        for row in np.flatnonzero(self.members & commanded).tolist():
            self._note(row, measured=False)
            if self._simulations[row].obey():
                self._simulations[row].world.drives.clear()
            else:
                self.leave(row, measured=False)
        rows = np.flatnonzero(self.members)
        for row in rows[self._left[rows] < ticks].tolist():
            self._left[row] = self._simulations[row].world.free_run.ahead(ticks, int(self._owed[row]))
        near = self._left[rows] < ticks
        self._go(rows[~near], ticks, ran)
        for row in rows[near].tolist():
            self._go_near(row, ticks, ran)
        for row in rows[ran[rows] < ticks].tolist():
            self.leave(row, measured=False)
        rows = rows[ran[rows] == ticks]
        if len(rows):
            assert self._courses is not None
            clocks = [self._simulations[row].clock for row in rows.tolist()]
            times = [
                one.origin + (one.tick + self._owed[row]) / one.frequency for one, row in zip(clocks, rows, strict=True)
            ]
            for column in self._columns:
                column.update(rows, self._courses, np.array(times))
        return ran

    def _go(self, rows: NDArray[np.int64], ticks: int, ran: NDArray[np.int64]) -> None:
        """Run ticks of rows, in which nothing is touched."""
        if len(rows):
            assert self._courses is not None
            done = self._courses.run(rows, ticks)
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

    # -- who is a member -----------------------------------------------------------------------

    def join(self, rows: Iterable[int]) -> None:
        """Let those rows be members in whose next steps nothing can happen, after a step with measurements."""
        for row in rows:
            if self._is_possible and not self._public[row] and self._simulations[row].coasts:
                self.members[row] = self._prepare(row)
            else:
                self._join_joints(row)

    def _prepare(self, row: int) -> bool:
        simulation = self._simulations[row]
        world = simulation.world
        course = world.free_run.course() if simulation.obey() else None
        world.drives.clear()
        if course is None:
            return False
        groups = len(world.positions)
        if self._courses is None:
            self._courses = Courses(len(self.members), groups)
        courses = self._courses
        if courses.positions.shape[1] != groups:
            return False
        courses.positions[row], courses.rotations[row] = world.positions.array, world.rotations.array
        courses.set(row, course)
        self._owed[row] = self._left[row] = 0
        return all(column.add(row, simulation, courses) for column in self._columns)

    def leave(self, row: int, *, measured: bool = True) -> None:
        """Bring the simulation of a row up to date.

        Args:
            measured: whether its sensors measure; False if they measure at the end of a step that follows.
        """
        self.joint_step.leave(row)
        if self.members[row]:
            self.members[row] = False
            self._note(row, measured=measured)

    def drop(self, row: int) -> None:
        """Let a row leave whose simulation begins anew."""
        self.joint_step.drop(row)
        self.leave(row)

    def _note(self, row: int, *, measured: bool) -> None:
        ticks, self._owed[row] = int(self._owed[row]), 0
        if ticks:
            self._simulations[row].world.free_run.ran(ticks)
            self._simulations[row].coasted(ticks, measured=measured)


class _Moment(Snapshot):
    """The poses of one sensor in each of N simulations.

    Args:
        positions, rotations: (N, 3) m, (N, 9) of the rigid groups of the sensors.
        places: of the sensors in these groups.
    """

    __slots__ = ("_places",)

    def __init__(self, positions: NDArray[np.float64], rotations: NDArray[np.float64], places: Mountings) -> None:
        super().__init__(positions, rotations, range(len(positions)), ())
        self._places = places

    @classmethod
    def poses_at(cls, moments: Sequence[Any]) -> tuple[Numbers, Numbers]:
        """Return the positions (3) and rotations (9, row by row) of the N sensors at the only moment, (1, N) each."""
        (one,) = moments
        positions, rotations = one.group_positions[None], one.group_rotations[None]
        return PoseRows(positions, rotations, [one._places], _FIRST).carried(slice(None))


class Reading:
    """Data that are computed for many rows at once.

    Attributes:
        is_possible: whether they are, for rows that glide.
        has_joints: whether these are positions of joints, of which `joint_step` knows.
        has_rates: the same for rates of turn of the robot.
    """

    def __init__(self, column: DataColumn, rows: int) -> None:
        self._column, self._handles = column, column.handles
        cls, layout = type(column.handles[0].component), column.layout
        columns = columns_of(cls)
        self.is_possible = columns is not None and layout.is_numeric_in((*columns.fields, _TIME))
        self.has_joints = columns is None and layout.dtype == np.float64 and hasattr(cls, "joint_places")
        self.has_rates = columns is None and layout.dtype.kind == "f" and hasattr(cls, "rate_place")
        self._slots = np.zeros(rows, np.int64)
        self._mountings: list[Any] = [None] * rows
        #: the rows of the last update, and the places of their sensors
        self._chosen: tuple[bytes, Mountings] | None = None
        self._bundle: RayBundle | None = None
        self._hits: Hits | None = None
        self._lanes: Lanes | None = None
        fields = [name for name in layout.fields if name != _TIME]
        self._joints = fields
        #: places of the rates of turn among the speeds of the engine
        self._places = np.zeros((rows, 3), np.intp)
        self._numbers = [number for number, name in enumerate(layout.fields) if name != _TIME]
        self._gathered: Gathered | None = None
        self._one = columns.one if columns is not None else None
        if columns is not None and self.is_possible:
            self._of, self._keep = columns.of, columns.keep
            #: the place of each field among the numbers of one sensor, which the time follows
            self._order = [[*columns.fields, _TIME].index(name) for name in layout.fields]
            self._lanes = Lanes(rows) if columns.keep is not None else None

    @property
    def has_columns(self) -> bool:
        """Whether they are, for some rows."""
        return self.is_possible or self.has_joints or self.has_rates

    def add(self, row: int, simulation: Simulation, courses: Courses | EngineRows) -> bool:
        """Prepare a row; return False if its data cannot be computed together with those of the others."""
        component: Any = self._handles[row].component
        entry = component._in_rows
        if not isinstance(entry, SensorRows):
            return False
        if self.has_joints:
            places = component.joint_places(self._joints) if isinstance(courses, EngineRows) else None
            if places is None or not isinstance(courses, EngineRows):
                return False
            if self._gathered is None:
                self._gathered = Gathered(courses.kernel, self._column.numbers)
            self._gathered.places[row, self._numbers] = np.add(places, courses.kernel.sizes.positions)
            return True
        if self.has_rates:
            place = component.rate_place(self._joints) if isinstance(courses, EngineRows) else None
            if place is None:
                return False
            self._places[row] = range(place, place + 3)
        elif columns_of(type(component)) is None:
            return False
        self._slots[row], self._mountings[row] = entry.place_of(component)
        self._chosen = None
        if self._lanes is None:
            return True
        bundle = component.rays
        if len(component.requests) != 1 or not isinstance(bundle, RayBundle) or component.observe() is not bundle.sight:
            return False
        if self._bundle is None or self._hits is None:
            self._bundle, self._hits = bundle, Hits.nothing((len(self._slots), len(bundle)))
        if len(bundle) != len(self._bundle) or bundle.reach != self._bundle.reach:
            return False
        hits = self._hits.rows(slice(row, row + 1))
        lane = simulation.world.rays.lane(bundle, courses.positions[row], courses.rotations[row], hits)
        if lane is None:
            return False
        self._lanes.set(row, lane)
        return True

    def groups(self, row: int) -> Sequence[int] | None:
        """The rigid groups whose poses are needed of a row; None for all, among which rays are cast."""
        if self.has_joints:
            return ()
        return None if self._lanes is not None else (int(self._slots[row]),)

    def update(self, rows: NDArray[np.int64], courses: Courses | EngineRows, times: NDArray[np.float64]) -> None:
        """Write the data of some rows, measured at these times (s)."""
        if self.has_joints:
            assert self._gathered is not None
            self._gathered.update()
            return
        if self._one is not None and len(rows) <= _FEW:
            numbers, slots = self._column.numbers, self._slots
            for row, time in zip(rows.tolist(), times.tolist(), strict=True):
                slot, mounting = slots[row], self._mountings[row]
                pose = courses.positions[row, slot].tolist(), courses.rotations[row, slot].tolist()
                values = *self._one(*mounting.carried(*pose)), time
                numbers[row] = [values[place] for place in self._order]
            return
        key = rows.tobytes()
        if self._chosen is None or self._chosen[0] != key:
            self._chosen = key, Mountings.of([self._mountings[row] for row in rows.tolist()])
        slots = self._slots[rows]
        moment = _Moment(courses.positions[rows, slots], courses.rotations[rows, slots], self._chosen[1])
        if self.has_rates:
            assert isinstance(courses, EngineRows)
            # as `Bodies.velocity` and the sensor
            speeds: Any = courses.speeds[rows[:, None], self._places[rows]].T
            here: Any = courses.rotations[rows, slots].T
            rates = turn(here, speeds)
            rotations: Any = [numbers[0] for numbers in moment.poses_at([moment])[1]]
            own = np.stack(turn_back(rotations, rates), axis=-1)[:, None]
            self._column.put(rows, {**dict.fromkeys(self._joints, own), _TIME: times[:, None]})
            return
        kept: list[np.ndarray] = []
        if self._lanes is not None and self._keep is not None and self._hits is not None and self._bundle is not None:
            self._lanes.cast(rows)
            scan = Scan(self._bundle, self._hits.rows(rows))
            kept = [self._keep(Sight(scan, row)) for row in range(len(rows))]
        self._column.put(rows, {**self._of([moment], [kept]), _TIME: times[:, None]})
