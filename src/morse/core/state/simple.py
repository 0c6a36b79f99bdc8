"""Immutable values of the Python standard library that are created from a few other values."""

from __future__ import annotations

from datetime import date, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

#: class to its word, and the function that returns its parts
TAKEN_APART: dict[type, tuple[str, Callable[[Any], list[object]]]] = {
    complex: ("complex", lambda v: [v.real, v.imag]),
    range: ("range", lambda v: [v.start, v.stop, v.step]),
    slice: ("slice", lambda v: [v.start, v.stop, v.step]),
    datetime: ("time", lambda v: [v.isoformat()]),
    date: ("day", lambda v: [v.isoformat()]),
    timedelta: ("duration", lambda v: [v.days, v.seconds, v.microseconds]),
    type(Path()): ("path", lambda v: [str(v)]),
}
#: word to the function that creates the value from its parts
PUT_TOGETHER: dict[str, Callable[..., object]] = {
    "complex": complex,
    "range": range,
    "slice": slice,
    "time": datetime.fromisoformat,
    "day": date.fromisoformat,
    "duration": timedelta,
    "path": Path,
}
