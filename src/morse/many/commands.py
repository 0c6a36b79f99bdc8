"""The commands of an actuator in all rows of a batch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.actuator import Actuator, PendingCommands
from morse.core.declarations import fields_of_component
from morse.core.validation.fields import spec_of_field
from morse.core.validation.spec import LARGEST, CommandError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.many.layout import Layout
    from morse.simulation.handles.component_handles import ComponentHandle


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
    """

    def __init__(self, layout: Layout, handles: Sequence[ComponentHandle]) -> None:
        rows = len(handles)
        self._layout, self._handles = layout, handles
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
            self._layout.fill(self._plain, row, self._handles[row].component.local_data)
            self._initial[row] = self._plain[row]
            assert self.array.written is not None
            self.array.written[row] = self._has_last[row] = False

    def check(self) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Check the commands of all rows.

        Returns:
            The rows to publish, and for each row whether its command may differ from the last one.

        Raises:
            CommandError: a value is not valid; the message names the row.
        """
        values, mask = self._plain, self.array.written
        assert mask is not None
        flat = values.reshape(len(values), -1)
        if not mask.all():
            # in-place operations such as `drive += 1` do not assign
            mask |= (flat != self._initial.reshape(flat.shape)).any(axis=1)
        rows = np.flatnonzero(mask)
        if not self._are_numbers:
            for row in rows.tolist():
                self._review(row)
            return rows, mask.copy()
        is_valid: NDArray[np.bool_] = (flat >= self._low) & (flat <= self._high)  # not of NaN
        if not is_valid.all():
            for row in rows[~np.all(is_valid, axis=1)[rows]].tolist():
                self._review(row)
        # the bytes, because 0.0 and -0.0 are equal
        now, before = flat.view(np.uint8), self._last.reshape(flat.shape).view(np.uint8)
        return rows, mask & (~self._has_last | (now != before).any(axis=1))

    def _review(self, row: int) -> None:
        try:
            self._pending_of(row).fitting(self._message(row))
        except CommandError as error:
            raise CommandError(error.field, f"row {row}: {self._layout.component}: {error}") from None

    def publish(self, rows: NDArray[np.intp]) -> None:
        """Give commands that `check` has accepted to the actuators."""
        self._last[rows], self._has_last[rows] = self._plain[rows], True
        if self._are_numbers and len(rows):
            names = self._layout.fields
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
        layout, values = self._layout, self._plain[row]
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
