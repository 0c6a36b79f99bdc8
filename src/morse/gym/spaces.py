"""Spaces of observations and actions, from declared data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.gym.task import Command, Read
    from morse.gym.values import Observation


def space_of(read: Read, declared: Mapping[str, DataField], values: NDArray[np.generic]) -> spaces.Box:
    """Return the space of data: uint8 for pictures, else float32 within the declared ranges.

    Args:
        declared: the declared data of the component.
        values: (N, ...) the present data.

    Raises:
        TypeError: the data are not numbers.
    """
    if values.dtype.kind not in "biuf":
        raise TypeError(f"{', '.join(read.fields)} of {read.component} is not made of numbers: it cannot be observed")
    shape = values.shape[1:] or (1,)
    if values.dtype == np.uint8:
        return spaces.Box(0, 255, shape, np.uint8)
    low, high = np.full(shape, -np.inf, np.float32), np.full(shape, np.inf, np.float32)
    if len(read.fields) == 1:
        limits(declared.get(read.fields[0]), low, high, ...)
    elif shape == (len(read.fields),):
        for index, name in enumerate(read.fields):
            limits(declared.get(name), low, high, index)
    return spaces.Box(low, high, dtype=np.float32)


def limits(field: Any, low: np.ndarray, high: np.ndarray, index: Any) -> None:
    """Set the range of a declared field."""
    if field is None:
        return
    if field.low is not None and "-inf" not in field.allow:
        low[index] = field.low
    if field.high is not None and "inf" not in field.allow:
        high[index] = field.high
    if field.angle:
        low[index], high[index] = np.float32(-np.pi), np.float32(np.pi)


def action_space(commands: Sequence[Command]) -> spaces.Box:
    """Return the space of the actions: the numbers of all commands, side by side."""
    low, high = np.array([limits for command in commands for limits in command.ranges.values()], np.float32).T
    return spaces.Box(low, high, dtype=np.float32)


def fitted(values: NDArray[np.generic], space: spaces.Space[Observation]) -> np.ndarray:
    """Return values of all rows in the type, the shape and the range of a space."""
    array = np.array(values, getattr(space, "dtype", None))
    shape = space.shape
    if shape is not None and array.shape[1:] != shape:
        array = array.reshape(len(array), *shape)
    if isinstance(space, spaces.Box) and array.dtype.kind == "f":
        np.clip(array, space.low, space.high, out=array)  # float32 may round beyond a limit
    return array
