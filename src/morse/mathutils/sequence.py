"""The base of vectors, angles, quaternions and colours: a short sequence of floats of fixed length."""

from __future__ import annotations

import collections.abc
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, Self, SupportsFloat, SupportsIndex, overload

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence

    _Base = Sequence[float]
else:
    _Base = object


def floats(values: Iterable[SupportsFloat], kind: str, smallest: int, largest: int) -> list[float]:
    """Return the values as floats.

    Raises:
        TypeError: the values are not numbers.
        ValueError: there are fewer than `smallest` or more than `largest` of them.
    """
    try:
        row = [float(value) for value in values]
    except (TypeError, ValueError):
        raise TypeError(f"{kind} takes {_count(smallest, largest)} numbers, given {values!r}") from None
    if not smallest <= len(row) <= largest:
        raise ValueError(f"{kind} takes {_count(smallest, largest)} numbers, given {len(row)}: {values!r}")
    return row


def is_number(value: object) -> bool:
    """Whether a value is an int, a float or a scalar of numpy."""
    return isinstance(value, (float, int, Real))


def rounded(value: float) -> str:
    """Return a component in the format of Blender: at most four decimals."""
    return f"{value:.4f}"


def _count(smallest: int, largest: int) -> str:
    return str(smallest) if smallest == largest else f"{smallest} to {largest}"


class FloatSequence(_Base):
    """A sequence of floats whose length does not change when items are assigned.

    The items are in `_items`: a list, a tuple after `freeze`, or the row or column of a matrix.
    """

    __slots__ = ("_items",)
    _items: MutableSequence[float]
    _sizes: ClassVar[tuple[int, int]]

    @classmethod
    def _wrap(cls, items: MutableSequence[float]) -> Self:
        """Create an instance from these items, which are neither copied nor checked."""
        sequence = cls.__new__(cls)
        sequence._items = items
        return sequence

    def __len__(self) -> int:
        return len(self._items)

    def __iter__(self) -> Iterator[float]:
        return iter(self._items)

    @overload
    def __getitem__(self, index: SupportsIndex) -> float: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[float, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return tuple(self._items[index])
        return self._items[index]

    @overload
    def __setitem__(self, index: SupportsIndex, value: float) -> None: ...
    @overload
    def __setitem__(self, index: slice, value: Iterable[float]) -> None: ...
    def __setitem__(self, index: Any, value: Any) -> None:
        if isinstance(index, slice):
            row = list(self._items)
            size = len(row)
            row[index] = floats(value, f"a slice of {type(self).__name__}", 0, size)
            if len(row) != size:
                raise ValueError(
                    f"the slice of {type(self).__name__} takes as many numbers as it has items, given {value!r}"
                )
            self._assign(row)
            return
        self._check_writable()
        try:
            self._items[index] = float(value)
        except (TypeError, ValueError):
            raise TypeError(f"{type(self).__name__} items are numbers, given {value!r} for {index!r}") from None

    def _assign(self, values: Sequence[float]) -> None:
        self._check_writable()
        self._items[:] = values

    def _check_writable(self) -> None:
        if isinstance(self._items, tuple):
            raise TypeError(f"this {type(self).__name__} is frozen: assign to a copy() of it")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return list(self._items) == list(other._items)

    def __hash__(self) -> int:
        if not isinstance(self._items, tuple):
            raise TypeError(f"unhashable type: '{type(self).__name__}'; freeze() it first")
        return hash(self._items)

    @property
    def is_frozen(self) -> bool:
        """Whether `freeze` was called."""
        return isinstance(self._items, tuple)

    def freeze(self) -> Self:
        """Make the object immutable, so that it can be a key of a dictionary. Return the object."""
        self._items = tuple(self._items)  # type: ignore[assignment]
        return self

    def copy(self) -> Self:
        """Return a copy that is not frozen, and not a view of a matrix."""
        return self._wrap(list(self._items))

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, object]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return type(self), (tuple(self._items),)


collections.abc.Sequence.register(FloatSequence)
