"""Limits of what a saved state may stand for: a few bytes can refer to the same lists again and again."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from morse.core.state.errors import StateError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

#: maximum number of items that references to earlier lists may stand for
_MOST = 10_000_000
#: maximum nesting depth, references included
_DEEPEST = 340
#: maximum number of items of a set with the same hash: the hashes of numbers and tuples are known to everybody
_MOST_ALIKE = 100
_Item = TypeVar("_Item")


class Extents:
    """Counts the items of nested values, and those of earlier values to which they refer.

    The items of an object count for the object, and not for a list that contains it: graphs of objects may have cycles,
    and nothing expands them.
    """

    def __init__(self) -> None:
        self._of: dict[int, tuple[int, int]] = {}
        self._items = self._height = self._repetitions = 0

    def begin(self) -> tuple[int, int]:
        """Begin a nested value; the result is an argument of `end`."""
        outer = self._items, self._height
        self._items = self._height = 0
        return outer

    def end(self, outer: tuple[int, int], value: object, *, counts: bool) -> None:
        """End a nested value.

        Args:
            counts: whether its items count for the value that contains it.
        """
        items, height = (self._items + 1, self._height + 1) if counts else (1, 1)
        self._of[id(value)] = items, height
        self._items, self._height = outer[0] + items, max(outer[1], height)

    def count(self, items: int) -> None:
        """Count items that are not nested values."""
        self._items += items

    def refer(self, value: object, depth: int) -> None:
        """Count an earlier value once more, at a nesting depth.

        Raises:
            StateError: the limits are exceeded.
        """
        items, height = self._of.get(id(value), (1, 1))
        if depth + height > _DEEPEST:
            raise StateError("the saved state is nested too deeply")
        self.repeat(items)
        self._height = max(self._height, height)

    @staticmethod
    def spread(items: Iterable[_Item]) -> Iterator[_Item]:
        """Iterate over items of a set, or keys of a dictionary.

        Raises:
            StateError: many have the same hash: each of them would be compared with all others.
        """
        counts: dict[int, int] = {}
        for item in items:
            code = hash(item)
            counts[code] = count = counts.get(code, 0) + 1
            if count > _MOST_ALIKE:
                raise StateError("the saved state contains a set or a dictionary in which too many hashes are equal")
            yield item

    def repeat(self, items: int) -> None:
        """Count items of an earlier value once more.

        Raises:
            StateError: the limit is exceeded.
        """
        self._items += items
        self._repetitions += items
        if self._repetitions > _MOST:
            raise StateError("the saved state refers to the same values too often")
