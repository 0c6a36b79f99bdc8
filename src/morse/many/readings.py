"""Arrays of data that are updated at the end of each step of a batch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.rows.lazy_data import present_data

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.many.layout import Layout
    from morse.simulation.handles.component_handles import ComponentHandle
    from morse.simulation.handles.world_changes import Contacts as Watch


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
            if all(np.size(data[name]) for name in self.layout.fields):
                self.layout.fill(self._values, row, data)

    def update(self, rows: Iterable[int]) -> None:
        """Take the present data."""
        fill, values = self.layout.fill, self._values
        for row in rows:
            fill(values, row, self._data_of(row))

    def put(self, rows: NDArray[np.intp], data: Mapping[str, np.ndarray | Sequence[object]]) -> None:
        """Take data of some rows, by field; see `Layout.fill_rows`."""
        self.layout.fill_rows(self._values, rows, data)

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
