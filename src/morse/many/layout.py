"""The layout of data fields of a component in an array with one row for each simulation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.reports.quoting import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

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

    def empty(self, rows: int) -> np.ndarray:
        """Return (rows, *shape) zeros."""
        return np.zeros((rows, *self.shape), self.dtype)

    def columns(self, field: int) -> slice:
        """Return the columns of a field in an array of several fields."""
        first = sum(math.prod(shape) for shape in self.shapes[:field])
        return slice(first, first + math.prod(self.shapes[field]))

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
        for index, (name, shape) in enumerate(zip(self.fields, self.shapes, strict=True)):
            values = data[name]
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
