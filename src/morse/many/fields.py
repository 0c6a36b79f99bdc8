"""Data fields of a component in all rows of a batch: the layout of their array, readings, and commands."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.actuator import Actuator, PendingCommands
from morse.core.declarations import fields_of_component
from morse.core.reports.quoting import nearest
from morse.core.rows.marks import present_data
from morse.core.validation.fields import spec_of_field
from morse.core.validation.spec import LARGEST, CommandError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.simulation.handles.component_handles import ComponentHandle
    from morse.simulation.handles.world_changes import Contacts as Watch


#: shape of a picture with an opacity, which is always 255 and no part of an observation
_RGBA = 4


class Layout:
    """The shape and type of some fields.

    One field keeps its shape: ``range_list`` of 181 distances is an array (N, 181), and a number is an array (N,). The
    numbers of several fields stand side by side: ``x``, ``y``, ``yaw`` are an array (N, 3).

    Attributes:
        component: full name of the component.
        fields: names of the fields.
        shape: shape of a row.
        dtype: type of the array; ``object`` for data that are not numbers.
        shapes: shape of each field in the data of the component.

    Args:
        data: data of a component that has measured.

    Raises:
        KeyError: the component has no such field.
        TypeError: several fields of which one contains no numbers.
    """

    def __init__(self, component: str, fields: Sequence[str], data: Mapping[str, object]) -> None:
        self.component, self.fields = component, tuple(fields)
        if not fields:
            raise TypeError(f"{component}: name the fields, which are {', '.join(data)}")
        for name in fields:
            if name not in data:
                raise KeyError(f"{component} has no field '{name}'{nearest(name, list(data))}")
        values = [_array(data[name]) for name in fields]
        self._crops = values[0].dtype == np.uint8 and values[0].ndim == 3 and values[0].shape[2] == _RGBA
        if len(values) == 1:
            value = values[0][..., :3] if self._crops else values[0]
            self.shape, self.dtype = (() if value.dtype == object else value.shape), value.dtype
        else:
            for name, value in zip(fields, values, strict=True):
                if value.dtype == object:
                    raise TypeError(f"{component}: '{name}' contains no numbers: read it without other fields")
            self.shape = (sum(value.size for value in values),)
            self.dtype = np.result_type(*values)
        self.shapes = [value.shape for value in values]
        self._are_scalars = all(shape == () for shape in self.shapes)
        ends = list(itertools.accumulate(math.prod(shape) for shape in self.shapes))
        #: the columns of each field in an array of several fields
        self._columns = [slice(first, end) for first, end in zip([0, *ends], ends, strict=False)]

    def empty(self, rows: int) -> np.ndarray:
        """Return (rows, *shape) zeros."""
        return np.zeros((rows, *self.shape), self.dtype)

    def columns(self, field: int) -> slice:
        """Return the columns of a field in an array of several fields."""
        return self._columns[field]

    def fill(self, array: np.ndarray, row: int, data: Mapping[str, object]) -> None:
        """Copy the fields of a component into a row.

        Raises:
            ValueError: a field has another shape than in the other rows.
        """
        if self.dtype == object:
            array[row] = data[self.fields[0]]
            return
        if len(self.fields) == 1:
            value = data[self.fields[0]]
            if self.shape:
                value = _array(value)
                value = value[..., :3] if self._crops else value
                if value.shape != self.shape:
                    self._refuse(row, value.shape)
            array[row] = value
            return
        if self._are_scalars:
            array[row] = [data[name] for name in self.fields]
            return
        values = [_array(data[name]) for name in self.fields]
        for value, shape in zip(values, self.shapes, strict=True):
            if value.shape != shape:
                self._refuse(row, value.shape)
        array[row] = np.concatenate([value.ravel() for value in values])

    def is_numeric_in(self, fields: Sequence[str]) -> bool:
        """Whether all fields are among others, and `fill_rows` can copy them."""
        return self.dtype.kind == "f" and set(self.fields) <= set(fields)

    def fill_rows(
        self, array: np.ndarray, rows: NDArray[np.intp], data: Mapping[str, np.ndarray | Sequence[object]]
    ) -> None:
        """Copy the fields of components into M rows.

        Args:
            data: by field, the data of each component at one moment: M times (1, ...).

        Raises:
            ValueError: see `fill`.
        """
        if self._are_scalars and len(self.fields) > 1:
            array[rows] = np.array([data[name] for name in self.fields]).reshape(len(self.fields), -1).T
            return
        for index, (name, shape) in enumerate(zip(self.fields, self.shapes, strict=True)):
            values = data[name]
            if isinstance(values, np.ndarray) and values.shape[2:] == shape:
                every = values.reshape(len(rows), *shape)
            else:
                for row, value in zip(rows.tolist(), values, strict=True):
                    if value[0].shape != shape:
                        self._refuse(row, value[0].shape)
                every = np.asarray(values).reshape(len(rows), *shape)
            if len(self.fields) == 1:
                array[rows] = every
            else:
                array[rows, self.columns(index)] = every.reshape(len(rows), -1)

    def _refuse(self, row: int, shape: tuple[int, ...]) -> None:
        mend = "fields of varying length have no column"
        if "points" in self.fields:
            mend += "; properties(keep_resolution=True) gives one point for each pixel"
        raise ValueError(
            f"row {row}: {', '.join(self.fields)} of {self.component} has the shape {shape}, "
            f"in the first row {self.shape}: {mend}"
        )


def _array(value: object) -> NDArray[np.generic]:
    """Return numbers as an array of their type, everything else as an array of one object."""
    try:
        array = np.asarray(value)
    except ValueError:  # lists of different lengths
        array = np.empty((), object)
    if array.dtype.kind in "biuf":
        return array
    single = np.empty((), object)
    single[()] = value
    return single


class DataColumn:
    """The data of a component in all rows.

    Attributes:
        array: (N, ...) the data, read-only.
        layout: their layout.
        handles: the component in all rows.
    """

    def __init__(self, layout: Layout, handles: Sequence[ComponentHandle]) -> None:
        self.layout, self.handles = layout, handles
        self._values = layout.empty(len(handles))
        self.array = self._values.view()
        self.array.flags.writeable = False
        self.begin(range(len(handles)))

    def begin(self, rows: Iterable[int]) -> None:
        """Take the data of rows that may not have measured yet: arrays are then empty, and stay 0 here."""
        for row in rows:
            data = self._data_of(row)
            self._values[row] = None if self._values.dtype == object else 0
            if all(type(data[name]) is float or np.size(data[name]) for name in self.layout.fields):
                self.layout.fill(self._values, row, data)

    def update(self, rows: Iterable[int]) -> None:
        """Take the present data."""
        fill, values = self.layout.fill, self._values
        for row in rows:
            fill(values, row, self._data_of(row))

    def put(self, rows: NDArray[np.intp], data: Mapping[str, np.ndarray | Sequence[object]]) -> None:
        """Take data of some rows, by field; see `Layout.fill_rows`."""
        self.layout.fill_rows(self._values, rows, data)

    @property
    def numbers(self) -> NDArray[np.float64]:
        """The array itself, (N, F), for who writes numbers into it."""
        return self._values.reshape(len(self._values), -1)

    def _data_of(self, row: int) -> Fields:
        component = self.handles[row].component
        # columns of objects keep what they refer to
        return component.local_data if self._values.dtype == object else present_data(component)


class Contacts(np.ndarray):
    """Whether a robot has touched anything but the floor.

    Attributes:
        impulse: (N,) sum of the magnitudes of the impulses of these contacts, N·s.
    """

    impulse: NDArray[np.float64] | None = None

    def __array_finalize__(self, other: object) -> None:
        """Impulses belong to the array itself, not to arrays that are computed from it."""
        self.impulse = None


class ContactColumn:
    """The contacts of a robot in all rows since the last step.

    Attributes:
        array: (N,) booleans, read-only, with the impulses.
    """

    def __init__(self, watches: Sequence[Watch]) -> None:
        self._watches = watches
        self._has_contact, self._impulses = np.zeros(len(watches), bool), np.zeros(len(watches))
        self.array = self._has_contact.view(Contacts)
        impulse = self._impulses.view()
        self.array.flags.writeable = impulse.flags.writeable = False
        self.array.impulse = impulse

    def begin(self, rows: Iterable[int]) -> None:
        """Let rows have no contacts."""
        numbers = list(rows)
        self._has_contact[numbers], self._impulses[numbers] = False, 0.0

    def update(self, rows: Iterable[int]) -> None:
        """Take the contacts of the step."""
        for row in rows:
            watch = self._watches[row]
            self._has_contact[row], self._impulses[row] = watch.touched, watch.impulse


class Command(np.ndarray):
    """An array of commands, which notes the rows that are assigned."""

    written: NDArray[np.bool_] | None = None

    def __array_finalize__(self, other: object) -> None:
        """Notes belong to the array itself, not to arrays that are computed from it."""
        self.written = None

    def __setitem__(self, key: Any, value: Any) -> None:
        super().__setitem__(key, value)
        if self.written is not None:
            self.written[key[0] if isinstance(key, tuple) and key else key] = True


class CommandColumn:
    """Publishes the rows of an array before each step.

    A row is published from the first assignment on. Until then, and after a restart, its actuator has no command.

    Attributes:
        array: (N, ...) the commands of all rows.
        layout: their layout.
        name: full name of the actuator.
    """

    def __init__(self, layout: Layout, handles: Sequence[ComponentHandle]) -> None:
        rows = len(handles)
        self.layout, self._handles, self.name = layout, handles, handles[0].fqn
        self._every = np.arange(rows)
        self._pending: list[PendingCommands | None] = [None] * rows
        self._actuators: list[object] = [None] * rows
        self.array = layout.empty(rows).view(Command)
        self.array.written = np.zeros(rows, bool)
        self._plain: np.ndarray = self.array.view(np.ndarray)
        self._initial = self._plain.copy()
        #: what was published last, and whether anything was
        self._last, self._has_last = self._plain.copy(), np.zeros(rows, bool)
        component = handles[0].component
        fields, data = fields_of_component(component), component.local_data
        specs = [spec_of_field(fields.get(name), data[name]) for name in layout.fields]
        #: whether commands are numbers that are checked all at once; others are checked one by one
        self._are_numbers = all(spec.kind == "number" for spec in specs)
        self._low = np.array([-LARGEST if spec.low is None else spec.low for spec in specs])
        self._high = np.array([LARGEST if spec.high is None else spec.high for spec in specs])
        self._whole = [spec.kind in ("integer", "boolean") for spec in specs]
        self.forget(range(rows))

    def forget(self, rows: Iterable[int]) -> None:
        """Take the present data of the actuators; the rows have no command."""
        for row in rows:
            self.layout.fill(self._plain, row, self._handles[row].component.local_data)
            self._initial[row] = self._plain[row]
            assert self.array.written is not None
            self.array.written[row] = self._has_last[row] = False

    def check(self) -> NDArray[np.intp]:
        """Check the commands of all rows; return the rows that have one.

        Raises:
            CommandError: a value is not valid; the message names the row.
        """
        values, mask = self._plain, self.array.written
        assert mask is not None
        flat = values.reshape(len(values), -1)
        rows = self._every
        if np.count_nonzero(mask) < len(rows):
            # in-place operations such as `drive += 1` do not assign
            mask |= (flat != self._initial.reshape(flat.shape)).any(axis=1)
            rows = np.flatnonzero(mask)
        if not self._are_numbers:
            for row in rows.tolist():
                self._review(row)
            return rows
        is_valid: NDArray[np.bool_] = (flat >= self._low) & (flat <= self._high)  # not of NaN
        if np.count_nonzero(is_valid) < is_valid.size:
            for row in rows[~np.all(is_valid, axis=1)[rows]].tolist():
                self._review(row)
        return rows

    def changes(self) -> NDArray[np.bool_]:
        """Whether a row (N,) has a command that may differ from the last one."""
        written = self.array.written
        assert written is not None
        if not self._are_numbers:
            return written.copy()
        flat = self._plain.reshape(len(self._plain), -1)
        # the bytes, because 0.0 and -0.0 are equal
        now, before = flat.view(np.uint8), self._last.reshape(flat.shape).view(np.uint8)
        differs: NDArray[np.bool_] = written & (~self._has_last | (now != before).any(axis=1))
        return differs

    def _review(self, row: int) -> None:
        try:
            self._pending_of(row).fitting(self._message(row))
        except CommandError as error:
            raise CommandError(error.field, f"row {row}: {self.layout.component}: {error}") from None

    def take(self, rows: NDArray[np.intp]) -> NDArray[np.float64]:
        """Take note of the commands of some rows, numbers that `check` has accepted, in place of `publish`.

        Returns:
            (N, F) the commands of all rows, contiguous.
        """
        if len(rows) == len(self._every):
            self._last[:], self._has_last[:] = self._plain, True
        else:
            self._last[rows], self._has_last[rows] = self._plain[rows], True
        return np.ascontiguousarray(self._plain.reshape(len(self._every), -1), np.float64)

    def repeat(self, row: int) -> None:
        """Give the last command that `take` has returned for a row, if there is one, to the actuator."""
        if self._has_last[row]:
            values = self._last[row].reshape(-1).tolist()
            self._pending_of(row).put(dict(zip(self.layout.fields, values, strict=True)))

    def publish(self, rows: NDArray[np.intp]) -> None:
        """Give commands that `check` has accepted to the actuators."""
        self._last[rows], self._has_last[rows] = self._plain[rows], True
        if self._are_numbers and len(rows):
            names = self.layout.fields
            for row, values in zip(rows.tolist(), self._plain[rows].reshape(len(rows), -1).tolist(), strict=True):
                self._pending_of(row).put(dict(zip(names, values, strict=True)))
            return
        for row in rows.tolist():
            self._pending_of(row).give(self._message(row))

    def _pending_of(self, row: int) -> PendingCommands:
        """The input of the present actuator of a row: a restart creates new actuators."""
        component, pending = self._handles[row].component, self._pending[row]
        if pending is None or component is not self._actuators[row]:
            assert isinstance(component, Actuator)
            pending = self._pending[row] = PendingCommands(component)
            self._actuators[row] = component
        return pending

    def _message(self, row: int) -> Fields:
        layout, values = self.layout, self._plain[row]
        if len(layout.fields) == 1:
            return {layout.fields[0]: values.tolist() if isinstance(values, np.ndarray) else _item(values)}
        message: Fields = {}
        for index, (name, whole) in enumerate(zip(layout.fields, self._whole, strict=True)):
            part = values[layout.columns(index)].reshape(layout.shapes[index]).tolist()
            is_whole = whole and isinstance(part, float) and part.is_integer()
            message[name] = int(part) if is_whole else part
        return message


def _item(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value
