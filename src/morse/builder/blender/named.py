"""Lists of named items, like Blender's collections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, SupportsIndex, TypeVar, overload

from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.values import Value


class Named(Protocol):
    """An item with a name."""

    @property
    def name(self) -> str:
        """The name."""


_T = TypeVar("_T", bound=Named)


class NamedList(list[_T]):
    """A list whose items can also be accessed by name; iteration yields the items.

    Args:
        items: the items.
        kind: name for an item in messages.
    """

    def __init__(self, items: Iterable[_T], kind: str) -> None:
        super().__init__(items)
        self._kind = kind

    @overload
    def __getitem__(self, key: SupportsIndex | str) -> _T: ...
    @overload
    def __getitem__(self, key: slice) -> list[_T]: ...
    def __getitem__(self, key: SupportsIndex | slice | str) -> _T | list[_T]:
        if not isinstance(key, str):
            return super().__getitem__(key)
        for item in self:
            if item.name == key:
                return item
        raise KeyError(f"no {self._kind} '{key}'{checks.suggestion(key, self.keys())}")

    def __contains__(self, item: object) -> bool:
        return self.get(item) is not None if isinstance(item, str) else super().__contains__(item)

    def get(self, name: str, default: object = None) -> Value:
        """Return the item of that name, or ``default``."""
        return next((item for item in self if item.name == name), default)

    def keys(self) -> list[str]:
        """The names."""
        return [item.name for item in self]

    def values(self) -> list[_T]:
        """The items."""
        return list(self)

    def items(self) -> list[tuple[str, _T]]:
        """Names and items."""
        return [(item.name, item) for item in self]
