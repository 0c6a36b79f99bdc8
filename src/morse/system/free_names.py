"""Names that nothing else has."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

#: numbers that are tried one after another
_FIRST = 100


def free_name(name: str, is_taken: Callable[[str], bool], *, first: int = 2, digits: int = 1) -> str:
    """Return a name that is not taken: the name itself, or with a number, as a rule the first one that is free.

    The time for a thousand equal names in a file is in proportion to their number: after the first numbers, the end of
    a row of taken ones is searched by halves.

    Args:
        is_taken: whether something has a name.
        first: the lowest number.
        digits: minimum number of digits.
    """

    def numbered(number: int) -> str:
        return f"{name}_{number:0{digits}d}"

    if not is_taken(name):
        return name
    for number in range(first, first + _FIRST):
        if not is_taken(numbered(number)):
            return numbered(number)
    taken, step = first + _FIRST - 1, _FIRST
    while is_taken(numbered(taken + step)):
        taken, step = taken + step, 2 * step
    free = taken + step
    while free - taken > 1:
        middle = (free + taken) // 2
        taken, free = (middle, free) if is_taken(numbered(middle)) else (taken, middle)
    return numbered(free)


def free_path(path: Path) -> Path:
    """Return the path of a file that does not exist: the path itself, or with the first number that is free, from 2."""
    return path.with_stem(free_name(path.stem, lambda stem: os.path.lexists(path.with_stem(stem))))
