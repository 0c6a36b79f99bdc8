"""Addresses of the mathematical functions of the C library that Python uses.

C libraries round sine, cosine and their inverses differently. C code that must agree with Python calls the same
functions.
"""

from __future__ import annotations

import ctypes
import math
import sys
from ctypes import CFUNCTYPE, c_double
from functools import cache
from typing import Any

_UNARY, _BINARY = CFUNCTYPE(c_double, c_double), CFUNCTYPE(c_double, c_double, c_double)
#: number of arguments of each sign, between 0 and 1, with which functions are compared
_SAMPLES = 200


class Functions(ctypes.Structure):
    """``RecordFunctions`` of ``c/record.c``."""

    _fields_ = (("atan2", _BINARY), ("asin", _UNARY), ("sin", _UNARY), ("cos", _UNARY))


@cache
def functions() -> Functions | None:
    """Return the functions; None if the system has none that agree with the module `math`."""
    for name in ("ucrtbase",) if sys.platform == "win32" else (None, "libm.so.6"):
        try:
            library = ctypes.CDLL(name)
            found = Functions(*(_found(library, field, kind) for field, kind, *_ in Functions._fields_))
        except (OSError, AttributeError):
            continue
        if _agree(found):
            return found
    return None


def _found(library: ctypes.CDLL, name: str, kind: Any) -> Any:
    return ctypes.cast(getattr(library, name), kind)


def _agree(found: Functions) -> bool:
    samples = [sign * (k + 0.37) / _SAMPLES for k in range(_SAMPLES) for sign in (1.0, -1.0)]
    return all(
        found.asin(x) == math.asin(x)
        and found.sin(4.0 * x) == math.sin(4.0 * x)
        and found.cos(4.0 * x) == math.cos(4.0 * x)
        and found.atan2(x, y) == math.atan2(x, y)
        for x, y in zip(samples, samples[7:] + samples[:7], strict=True)
        if abs(x) <= 1.0
    )
