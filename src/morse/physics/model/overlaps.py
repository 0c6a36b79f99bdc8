"""The message about objects that overlap at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.physics.model.separation import Pair

_NAMED = 5


def overlap_message(before: Mapping[Pair, float], after: Mapping[Pair, float]) -> str:
    """Return a message about the pairs of overlapping objects, the deepest first; empty if there are none.

    Args:
        before, after: the depths, m, of the pairs in the scene, and after `separate` has moved them apart.
    """
    if not before:
        return ""
    apart = {pair: depth for pair, depth in before.items() if pair not in after}
    close = {pair: depth for pair, depth in before.items() if pair in after}
    texts = [
        f"{_listing(pairs)} {what}"
        for pairs, what in ((apart, "were moved apart"), (close, "have no room and will be pushed apart"))
        if pairs
    ]
    return f"objects overlap at the start: {'; '.join(texts)}; move one object of each pair"


def _listing(depths: Mapping[Pair, float]) -> str:
    pairs = sorted(depths.items(), key=lambda item: -item[1])
    listing = ", ".join(f"'{a}' and '{b}' by {depth:.2g} m" for (a, b), depth in pairs[:_NAMED])
    return listing + (f" and {len(pairs) - _NAMED} more pairs" if len(pairs) > _NAMED else "")
