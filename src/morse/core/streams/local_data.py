"""Data fields that are computed when they are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.values import Fields, Value

if TYPE_CHECKING:
    from collections.abc import Callable, ItemsView, Iterator, ValuesView

    from numpy import ndarray


class Later:
    """An array that is computed on demand.

    Encoders call `tolist`, as for numpy arrays.

    Args:
        make: function that returns the array.
    """

    __slots__ = ("make",)

    def __init__(self, make: Callable[[], ndarray]) -> None:
        self.make = make

    def tolist(self) -> object:
        """The array as lists."""
        return self.make().tolist()


class LocalData(dict[str, Value]):
    """Data fields; the values of some may be of type `Later`.

    For readers it is a plain dictionary: a field is computed at the first access and then cached. A scan without
    readers is therefore never converted into lists, which would take longer than casting its rays.
    """

    def __getitem__(self, key: str) -> Value:
        value = super().__getitem__(key)
        if type(value) is Later:
            value = self[key] = value.make()
        return value

    def all_present(self) -> LocalData:
        """Compute all fields that have not been computed yet."""
        for key in self:
            self[key]
        return self

    def get(self, key: str, default: object = None) -> Value:
        """See `dict`."""
        if key in self:
            self[key]
        return super().get(key, default)

    def setdefault(self, key: str, default: object = None) -> Value:
        """See `dict`."""
        if key in self:
            self[key]
        return super().setdefault(key, default)

    def pop(self, key: str, *default: object) -> Value:
        """See `dict`."""
        if key in self:
            self[key]
        return super().pop(key, *default)

    def popitem(self) -> tuple[str, object]:
        """See `dict`."""
        self.all_present()
        return super().popitem()

    def items(self) -> ItemsView[str, Value]:  # type: ignore[override]
        """See `dict`."""
        self.all_present()
        return super().items()

    def values(self) -> ValuesView[Value]:  # type: ignore[override]
        """See `dict`."""
        self.all_present()
        return super().values()

    def copy(self) -> Fields:
        """See `dict`."""
        return dict(self.items())

    # `dict(...)` copies a subclass that defines this method by its keys and items, not its internal table
    def __iter__(self) -> Iterator[str]:
        return super().__iter__()

    def __or__(self, other: Any) -> Any:
        return self.copy() | other

    def __ror__(self, other: Any) -> Any:
        return other | self.copy()

    def __repr__(self) -> str:
        return repr(self.copy())
