"""Converts names of the simulation into Python names."""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

_FORBIDDEN = re.compile(r"[.\-~]")
_LONGEST, _DEEPEST = 256, 32
_COPY = re.compile(r"(?P<base>.+)_(?P<number>\d{3,})")


def normalize_name(name: str) -> str:
    """The attribute for a name of the simulation: ``.``, ``-`` and ``~`` become ``_``."""
    return _FORBIDDEN.sub("_", name)


def checked_name(name: object) -> str:
    """A name that a server sent: it becomes an attribute, a part of other names, and a part of messages.

    Raises:
        ValueError: it is not a name of a simulation.
    """
    if not isinstance(name, str) or not name.isprintable() or len(name) > _LONGEST or name.count(".") > _DEEPEST:
        raise ValueError(
            f"expected a name of at most {_LONGEST} printable characters and {_DEEPEST} dots, got {name!r:.80}"
        )
    return name


def checked_port(number: object) -> int:
    """A port that a server sent.

    Raises:
        ValueError: there is no such port.
    """
    text = str(number) if isinstance(number, (int, float, str)) else ""
    if not re.fullmatch(r"[0-9]{1,5}(\.0)?", text) or not 0 < int(float(text)) < 65536:
        raise ValueError(f"expected a port from 1 to 65535, got {number!r:.80}")
    return int(float(text))


def series(names: Iterable[str]) -> dict[str, list[str]]:
    """Return the lists of robots that loops of the scene script created.

    Args:
        names: normalised names of all robots.

    Returns:
        For ``m``, ``m_001``, ``m_002``, the entry ``ms`` with the three names in that order.
    """
    known = dict.fromkeys(names)
    copies: dict[str, list[tuple[int, str]]] = {}
    for name in known:
        match = _COPY.fullmatch(name)
        if match and match["base"] in known:
            copies.setdefault(match["base"], []).append((int(match["number"]), name))
    return {base + "s": [base, *(name for _, name in sorted(numbered))] for base, numbered in copies.items()}


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?``, or ``; there is: a, b``, for the end of an error message."""
    names = sorted(known)
    close = difflib.get_close_matches(word, names, n=1)
    if close:
        return f"; did you mean '{close[0]}'?"
    return f"; there is: {', '.join(names)}" if names else "; there are none"
