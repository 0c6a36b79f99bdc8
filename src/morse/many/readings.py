"""Data of rows that go on together, which are computed for many rows at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.rows.columns import columns_of
from morse.core.rows.rows import SensorRows
from morse.kernel.batched import Courses, Lanes
from morse.kernel.joints import Gathered
from morse.kernel.rays import Hits
from morse.mathutils.rotations import turn
from morse.physics.engine_rows import EngineRows
from morse.physics.poses.snapshot import Mountings, PoseRows, Snapshot
from morse.physics.rays.bundle import RayBundle, Scan, Sight
from morse.sensors.motion_sensor import MotionSensor, velocities_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.rows.columns import Columns
    from morse.many.fields import DataColumn
    from morse.physics.poses.snapshot import Numbers
    from morse.simulation.simulation import Simulation

    #: the poses of the rigid groups of N rows, and what else is known of them
    States = Courses | EngineRows


_FIRST = np.zeros(1, np.intp)
#: number of rows of which numbers take less time than arrays
_FEW = 8
#: the field of all sensors with the time of the measurement
_TIME = "timestamp"


def reading_of(column: DataColumn) -> Reading | None:
    """Return what computes the data of a column; None if that is possible in no row."""
    cls, layout = type(column.handles[0].component), column.layout
    columns = columns_of(cls)
    if columns is not None:
        return PoseReading(column, columns) if layout.is_numeric_in((*columns.fields, _TIME)) else None
    if layout.dtype == np.float64 and hasattr(cls, "joint_places"):
        return JointReading(column)
    return VelocityReading(column) if layout.dtype.kind == "f" and issubclass(cls, MotionSensor) else None


class Reading:
    """Data that are computed for many rows at once.

    Attributes:
        needs_engine: whether they are data of the engine, not of poses alone.
    """

    needs_engine = True

    def __init__(self, column: DataColumn) -> None:
        self._column, self._handles = column, column.handles
        self._class = type(column.handles[0].component)
        self._fields = [name for name in column.layout.fields if name != _TIME]

    def add(self, row: int, simulation: Simulation, states: States) -> bool:
        """Prepare a row; return False if its data cannot be computed together with those of the others."""
        component: Any = self._handles[row].component
        entry = component._in_rows
        if type(component) is not self._class or not isinstance(entry, SensorRows):
            return False
        return self._add(row, simulation, states, component, entry)

    def _add(self, row: int, simulation: Simulation, states: States, component: Any, entry: SensorRows) -> bool:
        raise NotImplementedError

    def groups(self, row: int) -> Sequence[int] | None:
        """The rigid groups whose poses are needed of a row; None for all, among which rays are cast."""
        raise NotImplementedError

    def update(self, rows: NDArray[np.int64], states: States, times: NDArray[np.float64]) -> None:
        """Write the data of some rows, measured at these times (s)."""
        raise NotImplementedError


class JointReading(Reading):
    """Positions of joints: numbers of the state of the engine."""

    def __init__(self, column: DataColumn) -> None:
        super().__init__(column)
        self._numbers = [number for number, name in enumerate(column.layout.fields) if name != _TIME]
        self._gathered: Gathered | None = None

    def _add(self, row: int, simulation: Simulation, states: States, component: Any, entry: SensorRows) -> bool:
        places = component.joint_places(self._fields)
        if places is None or not isinstance(states, EngineRows):
            return False
        if self._gathered is None:
            self._gathered = Gathered(states.kernel, self._column.numbers)
        self._gathered.places[row, self._numbers] = np.add(places, states.kernel.sizes.positions)
        return True

    def groups(self, row: int) -> Sequence[int] | None:
        """None are needed."""
        return ()

    def update(self, rows: NDArray[np.int64], states: States, times: NDArray[np.float64]) -> None:
        """Copy the numbers of the rows that take part."""
        assert self._gathered is not None
        self._gathered.update()


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


class _MountedReading(Reading):
    """Data of which the poses of the sensors are a part."""

    def __init__(self, column: DataColumn) -> None:
        super().__init__(column)
        rows = len(column.handles)
        self._slots = np.zeros(rows, np.int64)
        self._mountings: list[Any] = [None] * rows
        #: the rows of the last update, and the places of their sensors
        self._chosen: tuple[bytes, Mountings] | None = None

    def _mount(self, row: int, component: Any, entry: SensorRows) -> None:
        self._slots[row], self._mountings[row] = entry.place_of(component)
        self._chosen = None

    def groups(self, row: int) -> Sequence[int] | None:
        """The one that carries the sensor."""
        return (int(self._slots[row]),)

    def _moment(self, rows: NDArray[np.int64], states: States) -> _Moment:
        key = rows.tobytes()
        if self._chosen is None or self._chosen[0] != key:
            self._chosen = key, Mountings.of([self._mountings[row] for row in rows.tolist()])
        slots = self._slots[rows]
        return _Moment(states.positions[rows, slots], states.rotations[rows, slots], self._chosen[1])


class VelocityReading(_MountedReading):
    """Velocities of the robot; see `morse.sensors.motion_sensor.velocities_at`."""

    def __init__(self, column: DataColumn) -> None:
        super().__init__(column)
        #: places of velocity and rates of turn among the speeds of the engine
        self._places = np.zeros((len(column.handles), 6), np.intp)

    def _add(self, row: int, simulation: Simulation, states: States, component: Any, entry: SensorRows) -> bool:
        place = component.twist_place(self._fields)
        if place is None or not isinstance(states, EngineRows):
            return False
        self._places[row] = range(place, place + 6)
        self._mount(row, component, entry)
        return True

    def update(self, rows: NDArray[np.int64], states: States, times: NDArray[np.float64]) -> None:
        """Compute them of the speeds of the engine as `Bodies.velocity` and the sensor do."""
        assert isinstance(states, EngineRows)
        moment = self._moment(rows, states)
        speeds: Any = states.speeds[rows[:, None], self._places[rows]].T
        here: Any = moment.group_rotations.T
        rotations: Any = [numbers[0] for numbers in moment.poses_at([moment])[1]]
        velocities = velocities_at(rotations, speeds[:3], turn(here, speeds[3:]))
        data = {name: np.stack(velocities[name], axis=-1)[:, None] for name in self._fields}
        self._column.put(rows, {**data, _TIME: times[:, None]})


class PoseReading(_MountedReading):
    """Data that follow from the pose of the sensor, and from the rays of one scan."""

    needs_engine = False

    def __init__(self, column: DataColumn, columns: Columns) -> None:
        super().__init__(column)
        rows = len(column.handles)
        self._one, self._of, self._keep = columns.one, columns.of, columns.keep
        #: the place of each field among the numbers of one sensor, which the time follows
        self._order = [[*columns.fields, _TIME].index(name) for name in column.layout.fields]
        self._lanes = Lanes(rows) if columns.keep is not None else None
        self._bundle: RayBundle | None = None
        self._hits: Hits | None = None

    def _add(self, row: int, simulation: Simulation, states: States, component: Any, entry: SensorRows) -> bool:
        self._mount(row, component, entry)
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
        lane = simulation.world.rays.lane(bundle, states.positions[row], states.rotations[row], hits)
        if lane is None:
            return False
        self._lanes.set(row, lane)
        return True

    def groups(self, row: int) -> Sequence[int] | None:
        """The one that carries the sensor, or all of them."""
        return None if self._lanes is not None else super().groups(row)

    def update(self, rows: NDArray[np.int64], states: States, times: NDArray[np.float64]) -> None:
        """Cast the rays, and compute the data; of few rows one by one."""
        if self._one is not None and len(rows) <= _FEW:
            numbers, slots = self._column.numbers, self._slots
            for row, time in zip(rows.tolist(), times.tolist(), strict=True):
                slot, mounting = slots[row], self._mountings[row]
                pose = states.positions[row, slot].tolist(), states.rotations[row, slot].tolist()
                values = *self._one(*mounting.carried(*pose)), time
                numbers[row] = [values[place] for place in self._order]
            return
        kept: list[np.ndarray] = []
        if self._lanes is not None and self._keep is not None and self._hits is not None and self._bundle is not None:
            self._lanes.cast(rows)
            scan = Scan(self._bundle, self._hits.rows(rows))
            kept = [self._keep(Sight(scan, row)) for row in range(len(rows))]
        self._column.put(rows, {**self._of([self._moment(rows, states)], [kept]), _TIME: times[:, None]})
