"""Escapes and shortens text from outside (requests, messages, names in files) for messages, logs and terminals."""

from __future__ import annotations

import reprlib

#: largest number of characters of a text from outside that is repeated in a message
_LIMIT = 80
#: the first characters of a formula of a spreadsheet
_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")


def escaped(text: str) -> str:
    r"""Escape characters that control a terminal, end a line or cannot be encoded: ``\n``, ``\x1b``.

    A backslash is not escaped, because the text is for human readers.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def quoted(value: object, limit: int = _LIMIT) -> str:
    """Return a value from outside in quotes, escaped, and shortened to about ``limit`` characters.

    The time is bounded: a text of any length and a list of any depth take about the same time.
    """
    return f"'{short(value, limit)}'" if isinstance(value, str) else shown(value, limit)


def short(text: object, limit: int = _LIMIT) -> str:
    """Return a name from outside without quotes, escaped and shortened; return other values as `shown` does."""
    if not isinstance(text, str):
        return shown(text, limit)
    return escaped(text) if len(text) <= limit else f"{escaped(text[:limit])}… ({len(text)} characters)"


def shown(value: object, limit: int = _LIMIT) -> str:
    """Return the `repr` of a value, shortened to about ``limit`` characters; only the beginning is processed."""
    short = _Short()
    short.maxstring = short.maxother = short.maxlong = limit
    short.maxlist = short.maxtuple = short.maxset = short.maxdict = short.maxlevel = 6
    text = short.repr(value)
    return escaped(text if len(text) <= 2 * limit else text[: 2 * limit] + "…")


def spreadsheet_cell(value: object) -> object:
    """Return a value for a cell of a CSV file; a text that a spreadsheet would execute as a formula begins with ``'``.

    Spreadsheets take what begins with ``=``, ``+``, ``-`` or ``@`` for a formula, also within quotes, after spaces, and
    in the wide characters of East Asian keyboards. Texts that are numbers remain as they are.
    """
    if not isinstance(value, str) or not value.lstrip().startswith(_FORMULA):
        return value
    try:
        float(value)
    except ValueError:
        return f"'{value}"
    return value


class _Short(reprlib.Repr):
    def repr_str(self, x: str, level: int) -> str:
        """Return the repr of the beginning, because the repr of a long text takes a long time."""
        return repr(x) if len(x) <= self.maxstring else repr(x[: self.maxstring]) + "…"

    def repr_int(self, x: int, level: int) -> str:
        """Describe large integers by their size, because Python refuses to convert very large ones."""
        return repr(x) if x.bit_length() < 256 else f"an integer of {x.bit_length()} bits"

    def repr_dict(self, x: dict[object, object], level: int) -> str:
        """Keep the order of the keys, because sorting would process all of them."""
        if level <= 0:
            return "{…}"
        inside = ", ".join(
            f"{self.repr1(key, level - 1)}: {self.repr1(x[key], level - 1)}"
            for key, _ in zip(x, range(self.maxdict), strict=False)
        )
        return "{" + inside + (", …}" if len(x) > self.maxdict else "}")
