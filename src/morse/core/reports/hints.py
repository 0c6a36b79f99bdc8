"""Suggestions for misspelt names, for error messages."""

from __future__ import annotations

import difflib
from functools import partial
from heapq import nlargest
from typing import TYPE_CHECKING

from morse.core.reports.quoting import quoted, short

if TYPE_CHECKING:
    from collections.abc import Iterable

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
