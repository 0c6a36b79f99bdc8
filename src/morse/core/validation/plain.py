"""Limits for undeclared data from outside: nested lists and dictionaries."""

from __future__ import annotations

import math

#: maximum nesting depth
DEEPEST = 32
_LOWEST_INTEGER, _HIGHEST_INTEGER = -(2**63), 2**64 - 1


def check_text(text: str) -> None:
    """Raise an error for strings that cannot be encoded as UTF-8: lone surrogates.

    Raises:
        ValueError: the message contains the expected value.
    """
    if not text.isascii():
        try:
            text.encode()
        except UnicodeEncodeError:
            raise ValueError("valid Unicode (no lone surrogates)") from None


def check_plain(value: object, allow: frozenset[str] = frozenset()) -> None:
    """Raise an error for values that some middleware cannot carry, at any depth.

    Objects that are neither strings, numbers, lists nor dictionaries come from the process itself and are not checked.

    Args:
        allow: special values that are accepted: ``inf``, ``-inf`` and ``nan``.

    Raises:
        ValueError: the message contains the expected value.
    """
    queue: list[tuple[object, int]] = [(value, 0)]
    while queue:
        item, depth = queue.pop()
        if isinstance(item, float):
            if not math.isfinite(item) and str(float(item)) not in allow:
                raise ValueError("finite numbers")
        elif isinstance(item, str):
            check_text(item)
        elif isinstance(item, int):
            if not _LOWEST_INTEGER <= item <= _HIGHEST_INTEGER:
                raise ValueError("integers of at most 64 bits")
        elif isinstance(item, (list, tuple, dict)):
            if depth >= DEEPEST:
                raise ValueError(f"lists and objects nested at most {DEEPEST} deep")
            if isinstance(item, dict):
                queue.extend((key, depth + 1) for key in item)
                item = item.values()
            queue.extend((inner, depth + 1) for inner in item)


def size_of(value: object) -> int:
    """Estimate the size of a value in bytes; strings and list items are counted, objects of other types are not."""
    size = 0
    queue = [value]
    while queue:
        item = queue.pop()
        size += 16
        if isinstance(item, (str, bytes)):
            size += len(item)
        elif isinstance(item, dict):
            queue.extend(item)
            queue.extend(item.values())
        elif isinstance(item, (list, tuple)):
            queue.extend(item)
    return size
