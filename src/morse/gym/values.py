"""What tasks, environments and learners pass to each other: names of its types, and infos of one row and of many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

#: arrays by name, one row (N, ...) for each environment: the data, the values and the infos of a task
Arrays: TypeAlias = dict[str, np.ndarray]
#: observations in the form of the observation space: an array, or a dictionary of arrays
Observation: TypeAlias = Any
#: what an environment tells besides observations, rewards and ends: Gymnasium leaves the types of the values open
Infos: TypeAlias = dict[str, Any]
#: (N,) observations, rewards, terminated, truncated, and infos
Outcome: TypeAlias = tuple[Observation, np.ndarray, np.ndarray, np.ndarray, Infos]


def row_of(values: Any, row: int) -> Any:
    """Return the values of a row, of an array or a dictionary of arrays."""
    if isinstance(values, dict):
        return {name: array[row] for name, array in values.items()}
    return values[row]


def columns_of(values: Mapping[str, object], rows: int, source: str) -> Arrays:
    """Return infos of a task as arrays (N, ...), also those that are a single value for all rows.

    Args:
        source: what has returned them, for the message of an error.

    Raises:
        ValueError: an info has another number of rows.
    """
    columns: Arrays = {}
    for name, value in values.items():
        try:
            array = np.asarray(value)
        except ValueError:  # lists of different lengths
            array = np.empty(len(value), object)  # type: ignore[arg-type] # a list
            array[:] = value
        if array.ndim and len(array) != rows:
            raise ValueError(
                f"{source} has returned the info '{name}' of the shape {array.shape}, expected one value for all rows, "
                f"or an array ({rows}, ...)"
            )
        if (
            array.dtype.kind not in "biufc"
        ):  # as Gymnasium's own vectors: texts of several lengths have no type in common
            array = array.astype(object)
        columns[str(name)] = array.copy() if array.ndim else np.full(rows, array[()], array.dtype)
    return columns


def masked(columns: Arrays, mask: NDArray[np.bool_]) -> Infos:
    """Return infos as vectors of Gymnasium have them: ``name`` is 0 or None in other rows, ``_name`` is the mask."""
    infos: Infos = {}
    for name, column in columns.items():
        infos[name], infos[f"_{name}"] = _blank(column.shape, column.dtype), mask.copy()
        infos[name][mask] = column[mask]
    return infos


def stacked(infos: Mapping[int, Infos], rows: int) -> Infos:
    """Return the infos of some rows, by their numbers, in the form of `masked`."""
    columns: Arrays = {}
    mask = np.zeros(rows, bool)
    mask[list(infos)] = True
    for name in dict.fromkeys(name for one in infos.values() for name in one):
        values = {row: np.asarray(one[name]) for row, one in infos.items()}
        is_number = all(value.dtype.kind in "biuf" for value in values.values())
        shape = next(iter(values.values())).shape
        columns[name] = _blank((rows, *shape), np.dtype(np.float64 if is_number else object))
        for row, value in values.items():
            columns[name][row] = value if shape or is_number else value[()]
    return masked(columns, mask)


def joined(parts: Sequence[tuple[slice, Infos]], rows: int) -> Infos:
    """Return the infos of all rows, of the vectors of some rows each."""
    infos: Infos = {}
    for name in _names(part for _, part in parts):
        there = [(place, part[name]) for place, part in parts if name in part]
        if isinstance(there[0][1], dict):
            infos[name] = joined(there, rows)
            continue
        kind = np.result_type(*(array.dtype for _, array in there))
        infos[name] = _blank((rows, *there[0][1].shape[1:]), kind)
        for place, array in there:
            infos[name][place] = array
    return infos


def row_infos(infos: Infos, row: int) -> Infos:
    """Return the infos of a row that the infos of a vector contain, without those of the end of an episode."""
    return {
        name: values[row]
        for name, values in infos.items()
        if name not in ("final_obs", "final_info") and f"_{name}" in infos and infos[f"_{name}"][row]
    }


def _names(parts: Iterable[Infos]) -> list[str]:
    return list(dict.fromkeys(name for part in parts for name in part))


def _blank(shape: tuple[int, ...], dtype: np.dtype[Any]) -> np.ndarray:
    return np.full(shape, None, object) if dtype.kind == "O" else np.zeros(shape, dtype)
