"""Values in the form that the readers of messages get."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.kinds.kind import Slot
    from morse.core.values import Value

_SCALAR: dict[str, Callable[[Value], Value]] = {"bool": bool, "str": str, "int32": int}


def as_slot_rows(slot: Slot, value: Value) -> Value:
    """Return the values of many messages in the form of `as_slot`, with a first axis of rows; words are shared.

    Raises:
        TypeError: they are neither numbers nor words.
    """
    value_dtype = getattr(value, "dtype", None)
    if value_dtype is None:
        return as_slot(slot, value)
    if slot.dtype in ("str", "object") or value_dtype.kind not in "iufb":
        raise TypeError(f"slot '{slot.name}' is read one by one")
    dtype = "bool" if slot.dtype == "bool" else "int64" if slot.dtype in _SCALAR else "float64"
    if slot.shape:
        dtype = str(value_dtype) if str(value_dtype) in slot.dtypes else slot.dtype
    return value.astype(dtype, copy=False)


def as_slot(slot: Slot, value: Value) -> Value:
    """Return a value in the form that readers get: a C-contiguous read-only array, or a plain Python value."""
    if slot.shape == ():
        return _SCALAR.get(slot.dtype, float)(value)
    if slot.dtype in ("str", "object"):
        return tuple(value)
    import numpy as np

    value_dtype = getattr(value, "dtype", None)
    if value_dtype is None:
        result = np.array(value, slot.dtype, order="C")
        result.setflags(write=False)  # three times as fast as assigning flags.writeable
        return result
    dtype = str(value_dtype) if str(value_dtype) in slot.dtypes else slot.dtype
    array = np.ascontiguousarray(value, dtype=dtype).view()
    array.flags.writeable = False
    return array
