"""Rows, of a batch of simulations or of the robots of one simulation: their numbers, and arrays with a row for each."""

from __future__ import annotations

import numbers
import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.actuator import Actuator
from morse.core.declarations import fields_of_component
from morse.core.reports.quoting import nearest
from morse.core.rows.marks import present_data
from morse.core.sensor import Sensor
from morse.many.fields import CommandColumn, ContactColumn, DataColumn, Layout
from morse.simulation.handles.component_handles import handle_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.core.interfaces import Component
    from morse.core.values import Fields
    from morse.many.fields import Command, Contacts
    from morse.simulation.handles.component_handles import ComponentHandle
    from morse.simulation.simulation import Simulation


class RowArrays(ABC):
    """Commands and data of components as arrays with N rows; what a task of `morse.gym` uses.

    Each row of a `morse.many.batch.Batch` is a simulation, each row of a `morse.gym.agents.Team` a robot of one.
    """

    def __init__(self) -> None:
        self._commands: list[CommandColumn] = []
        self._readings: list[DataColumn | ContactColumn] = []
        self._samples: dict[str, Fields] | None = None

    @abstractmethod
    def __len__(self) -> int:
        """Return the number of rows, N."""

    @abstractmethod
    def _rows(self, rows: object) -> list[int]:
        """Return row numbers, see `rows_of`; their simulations are then up to date."""

    @abstractmethod
    def _simulation_of(self, row: int) -> Simulation:
        """Return the simulation of a row that `_rows` has returned."""

    @abstractmethod
    def _load_sample(self) -> Simulation:
        """Load another simulation of the first row."""

    def name_in(self, row: int, name: str) -> str:
        """Return the name in the simulation of a row for a name that the rows share."""
        return name

    # -- arrays ----------------------------------------------------------------------------

    def command(self, component: str, *fields: str) -> Command:
        """Return an array whose rows are published to an actuator before each `step`.

        A row is published from its first assignment on, until it is restarted or restored. The values are checked
        against the declared ranges before the step.

        Args:
            component: full name of an actuator, such as ``robot.motion``.
            fields: names of its data fields; by default all.

        Returns:
            (N, ...) the commands: one column for each number of several fields; the shape of the data for one field.

        Raises:
            KeyError: there is no such component or field.
            TypeError: the component is not an actuator.
            ValueError: a field is given twice.
        """
        handles = self._handles(component)
        actuator = handles[0].component
        if not isinstance(actuator, Actuator):
            kind = "a sensor" if isinstance(actuator, Sensor) else "a robot"
            raise TypeError(f"{component} is {kind}: use read()")
        names = fields or tuple(actuator.local_data)
        if len(set(names)) != len(names):
            raise ValueError(f"a field of {component} is given twice: {', '.join(map(str, names))}")
        column = CommandColumn(Layout(component, names, actuator.local_data), handles)
        self._commands.append(column)
        return column.array

    def read(self, component: str, *fields: str) -> np.ndarray:
        """Return an array of data that is updated, in place, at the end of each `step`; copy it to keep it.

        Args:
            component: full name of a sensor or an actuator.
            fields: names of its data fields; by default all.

        Returns:
            (N, ...) the data, read-only: one column for each number of several fields; for one field the shape of its
            data. Colour images are (N, H, W, 3) uint8, depths (N, H, W) float32. Data that are not numbers are objects.

        Raises:
            KeyError: there is no such component or field.
            ValueError: the sizes of the data differ between rows.
        """
        handles = self._handles(component)
        layout = self._layout(component, fields)
        for row in self._rows(None):
            self._simulation_of(row).measure_always(self.name_in(row, component))
        column = DataColumn(layout, handles)
        self._add_reading(column)
        return column.array

    def contacts(self, name: str) -> Contacts:
        """Return an array that states whether a robot has touched anything but the floor since the last `step`.

        Args:
            name: name of the robot, or of an object such as a crate.

        Returns:
            (N,) booleans, updated in place at the end of each step. Their attribute ``impulse`` (N,) is the sum of the
            magnitudes of the impulses of these contacts, N·s.

        Raises:
            KeyError: there is no such robot or object.
        """
        column = ContactColumn([self._simulation_of(row).contacts(self.name_in(row, name)) for row in self._rows(None)])
        self._readings.append(column)
        return column.array

    def declarations(self, name: str) -> Mapping[str, DataField]:
        """Return the declared data of a component, by field: units, frames, ranges.

        Raises:
            KeyError: there is no such component.
        """
        return fields_of_component(self._handles(name)[0].component)

    def _handles(self, name: str) -> list[ComponentHandle]:
        return [handle_of(self._simulation_of(row), self.name_in(row, name)) for row in self._rows(None)]

    def _layout(self, component: str, fields: tuple[str, ...]) -> Layout:
        """The sizes of the data are those of a measurement in a simulation of the scene that is then closed."""
        handle = self._handles(component)[0]
        data = present_data(handle.component)
        for name in fields:
            if name not in data:
                raise KeyError(f"{component} has no field '{name}'{nearest(name, list(data))}")
        if self._samples is None:
            with self._load_sample() as probe:
                probe.step(1, measure=True)
                context = probe.context
                parts: dict[str, Component] = {**context.robots, **context.components}
                measured = {name: part for name, part in parts.items() if not getattr(part, "on_demand", False)}
                self._samples = {name: dict(present_data(part)) for name, part in measured.items()}
        # what was spawned is not there
        sample = self._samples.get(handle.fqn, data)
        return Layout(component, fields or tuple(sample), sample)

    def _add_reading(self, column: DataColumn) -> None:
        self._readings.append(column)

    def _begin(self, rows: Sequence[int]) -> None:
        for column in self._commands:
            column.forget(rows)
        for reading in self._readings:
            reading.begin(rows)

    def _update(self, rows: Sequence[int] | range) -> None:
        for reading in self._readings:
            reading.update(rows)

    # -- changes ---------------------------------------------------------------------------

    def place(self, rows: object, name: str, poses: object) -> None:
        """Place a robot or an object at rest, in some rows.

        Args:
            poses: (M, 3) x, y, yaw; (M, 6) x, y, z, roll, pitch, yaw; or (M, 7) x, y, z and a quaternion w, x, y, z; m
                and rad, in the world. A single pose stands for all of these rows. With x, y, yaw the height is that of
                the scene.

        Raises:
            KeyError: there is no such object.
            ValueError: a pose has another size, or a number is not finite; nothing has moved then.
        """
        numbers = self._rows(rows)
        vectors = vectors_of(poses, numbers, "poses")
        names = [self.name_in(row, name) for row in numbers]
        simulations = [self._simulation_of(row) for row in numbers]
        checked = [one.pose_of(*pair) for one, *pair in zip(simulations, names, vectors.tolist(), strict=True)]
        for simulation, full, pose in zip(simulations, names, checked, strict=True):
            simulation.place(full, pose)

    def vary(
        self,
        name: str,
        *,
        rows: object = None,
        mass: object = None,
        friction: object = None,
        light: object = None,
        color: object = None,
        texture: object = None,
    ) -> None:
        """Change parameters of a robot or an object, one value for each row; `restart` restores those of the scene.

        Args:
            rows: row numbers, a slice or a mask; None for all.
            mass: kg; the inertia changes in proportion.
            friction: coefficient of sliding friction of its shapes.
            light: energy of its lamps, relative to a normal lamp.
            texture: paths of pictures; see `Simulation.set_texture`.
            color: (M, 3) red, green, blue of its surfaces, or of its light if it is a lamp; 0 to 1, linear.

        Raises:
            KeyError: there is no such object.
            ValueError: a value is not valid, or there is another number of values than rows; nothing has changed then.
            TypeError: no parameter is given.
        """
        values_by_name = {"mass": mass, "friction": friction, "light": light, "color": color, "texture": texture}
        values_by_name = {what: values for what, values in values_by_name.items() if values is not None}
        if not values_by_name:
            raise TypeError(f"vary needs a parameter of '{name}': mass, friction, light, color or texture")
        numbers = self._rows(rows)
        columns: dict[str, Any] = {what: _columns(what, values, numbers) for what, values in values_by_name.items()}
        changes = [
            (what, row, value) for what, each in columns.items() for row, value in zip(numbers, each, strict=True)
        ]
        for what, row, value in changes:
            self._simulation_of(row).check_variation(self.name_in(row, name), what, value)
        for what, row, value in changes:
            getattr(self._simulation_of(row), f"set_{what}")(self.name_in(row, name), value)


def _columns(what: str, values: object, rows: Sequence[int]) -> list[Any]:
    """Return the values of a parameter, one for each row."""
    if what == "color":
        return list(vectors_of(values, rows, "colors").tolist())
    return names_of(values, rows) if what == "texture" else values_of(values, rows, what)


def rows_of(rows: object, count: int) -> list[int]:
    """Return row numbers.

    Args:
        rows: None for all rows, a number, a slice, a list of numbers, or an array of ``count`` booleans.
        count: number of rows of the batch.

    Raises:
        IndexError: there is no such row.
        ValueError: a row is given twice.
        TypeError: it is not any of these.
    """
    if rows is None:
        return list(range(count))
    if isinstance(rows, slice):
        return list(range(count))[rows]
    try:
        array = np.asarray(rows)
    except ValueError:  # lists of different lengths
        array = np.empty((1, 1))
    if array.dtype == bool:
        if array.shape != (count,):
            raise IndexError(f"a mask of rows has the shape ({count},), not {array.shape}")
        return [int(row) for row in np.flatnonzero(array)]
    if array.size == 0:
        return []
    if array.dtype.kind not in "iu" or array.ndim > 1:
        raise TypeError(f"rows are a number, a list of numbers, a slice or a mask, not {rows!r:.80}")
    numbers = [int(row) for row in np.atleast_1d(array)]
    for row in numbers:
        if not -count <= row < count:
            raise IndexError(f"there is no row {row}: the batch has {count} rows, from 0 to {count - 1}")
    numbers = [row % count for row in numbers]
    if len(set(numbers)) != len(numbers):
        raise ValueError(f"a row is given twice: {numbers!r:.80}")
    return numbers


def only_row_of(row: object, count: int) -> int:
    """Return the number of one row.

    Raises:
        IndexError: there is no such row.
        TypeError: it is not a number.
    """
    if isinstance(row, bool) or not isinstance(row, numbers.Integral):
        raise TypeError(f"a row is an integer, not {row!r:.80}")
    return rows_of(row, count)[0]


def seeds_of(seeds: Any, rows: Sequence[int]) -> list[int]:
    """Return one seed for each row; a number ``s`` stands for the seeds ``s + row``.

    Raises:
        ValueError: there is another number of seeds than rows.
        TypeError: a seed is not an integer.
    """
    if isinstance(seeds, numbers.Integral) and not isinstance(seeds, bool):
        return [int(seeds) + row for row in rows]
    try:
        values = list(seeds)
    except TypeError:
        raise TypeError(f"seed is an integer, or a list of one integer for each row, not {seeds!r:.80}") from None
    if len(values) != len(rows):
        raise ValueError(f"there are {len(rows)} rows, but {len(values)} seeds")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, numbers.Integral):
            raise TypeError(f"a seed is an integer, not {value!r:.80}")
    return [int(value) for value in values]


def values_of(values: object, rows: Sequence[int], what: str) -> list[float]:
    """Return one number for each row; a number stands for all rows.

    Raises:
        ValueError: there is another number of values than rows.
    """
    array = _floats(values, what)
    if array.ndim == 0:
        return [float(array)] * len(rows)
    if array.shape != (len(rows),):
        raise ValueError(f"{what} has the shape {array.shape}, expected one number or ({len(rows)},)")
    return [float(value) for value in array]


def names_of(names: object, rows: Sequence[int]) -> list[str]:
    """Return one path for each row; a single path stands for all rows.

    Raises:
        ValueError: there is another number of paths than rows.
    """
    if isinstance(names, (str, os.PathLike)):
        return [os.fspath(names)] * len(rows)
    if not isinstance(names, Sequence) or len(names) != len(rows):
        raise ValueError(f"expected one path of a picture, or one for each of {len(rows)} rows, not {names!r:.100}")
    return [os.fspath(name) for name in names]


def vectors_of(values: object, rows: Sequence[int], what: str) -> NDArray[np.float64]:
    """Return (M, K) one vector for each row; a single vector stands for all rows.

    Raises:
        ValueError: another shape.
    """
    array = _floats(values, what)
    if array.ndim == 1:
        array = np.broadcast_to(array, (len(rows), len(array)))
    if array.ndim != 2 or len(array) != len(rows):
        raise ValueError(
            f"{what} have the shape {array.shape}, expected one vector, or one for each of {len(rows)} rows"
        )
    return array


def _floats(values: object, what: str) -> NDArray[np.float64]:
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{what}: {values!r:.80} is not an array of numbers") from None
