"""Escapes and shortens text from outside (requests, messages, names in files) for messages, logs and terminals."""

from __future__ import annotations

import difflib
import re
import reprlib
from functools import partial
from heapq import nlargest
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


#: largest number of characters of a text from outside that is repeated in a message
_LIMIT = 80
#: the first characters of a formula of a spreadsheet
_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
#: where a spreadsheet that separates by something else than a comma begins another cell, before a formula
_INNER = re.compile(r"([;\t\r\n][ \"]{0,8})(?=[=+\-@\uff1d\uff0b\uff0d\uff20])")


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
    in the wide characters of East Asian keyboards. Texts that are numbers remain as they are. Where the comma separates
    decimals, spreadsheets separate cells by ``;`` or tabs, and know no quotes within a cell: then ``'`` is within the
    text as well.
    """
    if not isinstance(value, str):
        return value
    if value.lstrip().startswith(_FORMULA):
        try:
            float(value)
        except ValueError:
            value = f"'{value}"
    return _INNER.sub(r"\1'", value)


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


#: words longer than this are not compared, because a comparison takes time quadratic in their length
_LONGEST_WORD = 120
#: largest number of names whose letters are compared with those of a word; and of these with the same order
_MOST_COMPARED, _MOST_ORDERED = 200, 40
#: largest number of names that a message lists
_MOST_LISTED = 50
#: difflib's cutoff of 0.6 cannot be reached if the shorter word has fewer than 3/7 of the letters of the longer word
_SHORTER, _LONGER = 3, 7


def closest(word: object, candidates: Iterable[object], cutoff: float = 0.6) -> str | None:
    """Return the known name most similar to ``word``, ignoring case, or None.

    Args:
        cutoff: likeness from 0 to 1 of a word and a name that is similar to it.
    """
    if not isinstance(word, str) or len(word) > _LONGEST_WORD:
        return None
    size = len(word)
    names = [
        name
        for name in candidates
        if isinstance(name, str) and min(size, len(name)) * _LONGER >= max(size, len(name)) * _SHORTER
    ]
    lower = word.casefold()
    if len(names) > _MOST_COMPARED:
        names = [name for name in names if name[:1].casefold() == lower[:1]][:_MOST_COMPARED]
    # of names that differ by case only, one with a capital letter is meant by such a word
    names.sort(key=lambda name: name[:1].isupper() == word[:1].isupper())
    by_folded = {name.casefold(): name for name in names}
    if len(by_folded) > _MOST_ORDERED:
        # to compare the order of the letters takes twenty times longer
        matcher = difflib.SequenceMatcher(b=lower)
        by_folded = {name: by_folded[name] for name in nlargest(_MOST_ORDERED, by_folded, partial(_likeness, matcher))}
    matches = difflib.get_close_matches(lower, by_folded, n=1, cutoff=cutoff)
    return by_folded[matches[0]] if matches else None


def _likeness(matcher: difflib.SequenceMatcher[str], name: str) -> float:
    """The largest ratio that the letters of a name allow."""
    matcher.set_seq1(name)
    return matcher.quick_ratio()


def nearest(word: object, candidates: Iterable[str], *, say: str = "known", limit: int = _MOST_LISTED) -> str:
    """Return ``; did you mean 'x'?`` for a near miss, else ``; known: a, b, c`` with at most ``limit`` names."""
    names = list(dict.fromkeys(candidates))
    near = closest(word, names)
    if near is not None:
        return f"; did you mean {quoted(near)}?"
    rest = f", and {len(names) - limit} more" if len(names) > limit else ""
    return f"; {say}: {', '.join(map(short, names[:limit]))}{rest}" if names else ""
