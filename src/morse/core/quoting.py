"""Text from outside (requests, messages, names in files) as it may stand in a message, a log or a terminal."""

from __future__ import annotations

import reprlib
from typing import Any

#: characters of a text from outside that a message repeats
_LIMIT = 80


def escaped(text: str) -> str:
    r"""The text without characters that control a terminal, end a line or cannot be encoded: ``\n``, ``\x1b``.

    A backslash stays as it is: the text is to be read, not to be parsed.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def quoted(value: Any, limit: int = _LIMIT) -> str:
    """A value from outside between quotes, escaped, and shortened to about ``limit`` characters.

    The work does not grow with the value: a text of any length and a list of any depth take the same time.
    """
    return f"'{short(value, limit)}'" if isinstance(value, str) else shown(value, limit)


def short(text: Any, limit: int = _LIMIT) -> str:
    """A name from outside without quotes, escaped and shortened; other things as `shown` does."""
    if not isinstance(text, str):
        return shown(text, limit)
    return escaped(text) if len(text) <= limit else f"{escaped(text[:limit])}… ({len(text)} characters)"


def shown(value: Any, limit: int = _LIMIT) -> str:
    """What `repr` says of a value, shortened to about ``limit`` characters; only the beginning is looked at."""
    short = _Short()
    short.maxstring = short.maxother = short.maxlong = limit
    short.maxlist = short.maxtuple = short.maxset = short.maxdict = short.maxlevel = 6
    text = short.repr(value)
    return escaped(text if len(text) <= 2 * limit else text[: 2 * limit] + "…")


class _Short(reprlib.Repr):
    def repr_str(self, x: str, level: int) -> str:
        """Only the beginning: the repr of all of a long text would take long."""
        return repr(x) if len(x) <= self.maxstring else repr(x[: self.maxstring]) + "…"

    def repr_int(self, x: int, level: int) -> str:
        """Integers of many digits take long to write, and Python refuses some."""
        return repr(x) if x.bit_length() < 256 else f"an integer of {x.bit_length()} bits"

    def repr_dict(self, x: dict[Any, Any], level: int) -> str:
        """In the order of the keys as they are: sorting them would look at all."""
        if level <= 0:
            return "{…}"
        inside = ", ".join(
            f"{self.repr1(key, level - 1)}: {self.repr1(x[key], level - 1)}"
            for key, _ in zip(x, range(self.maxdict), strict=False)
        )
        return "{" + inside + (", …}" if len(x) > self.maxdict else "}")
