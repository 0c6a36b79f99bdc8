"""Names that nothing else has."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def free_name(name: str, is_taken: Callable[[str], bool], *, first: int = 2, digits: int = 1) -> str:
    """Return a name that is not taken: the name itself, or with the first number that is free.

    Args:
        is_taken: whether something has a name.
        first: the lowest number.
        digits: minimum number of digits.
    """
    candidate, number = name, first
    while is_taken(candidate):
        candidate = f"{name}_{number:0{digits}d}"
        number += 1
    return candidate


def free_path(path: Path) -> Path:
    """Return the path of a file that does not exist: the path itself, or with the first number that is free, from 2."""
    return path.with_stem(free_name(path.stem, lambda stem: path.with_stem(stem).exists()))
