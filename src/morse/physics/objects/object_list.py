"""A list of objects that is indexed by number or by name."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar, overload

if TYPE_CHECKING:
    from morse.scene import Node


class Named(Protocol):
    """An object with a name in the scene."""

    @property
    def name(self) -> str:
        """The name in the scene."""

    @property
    def node(self) -> Node:
        """The node of the scene for this object."""


T = TypeVar("T", bound=Named)
_D = TypeVar("_D")


class ObjectList(Sequence[T], Generic[T]):
    """A list of objects that can also be indexed by name.

    A name matches the name in the scene or the name in the model file: the second robot of a kind has a ``left_eye``,
    although its name in the scene is ``left_eye.001``.
    """

    def __init__(self, objects: list[T]) -> None:
        self._objects = objects

    def _named(self, name: str) -> T | None:
        exact = next((obj for obj in self._objects if obj.name == name), None)
        return exact or next((obj for obj in self._objects if obj.node.plain_name == name), None)

    @overload
    def __getitem__(self, key: int | str) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> list[T]: ...
    def __getitem__(self, key: int | str | slice) -> T | list[T]:
        if not isinstance(key, str):
            return self._objects[key]
        found = self._named(key)
        if found is None:
            names = [obj.node.plain_name for obj in self._objects]
            close = difflib.get_close_matches(key, names, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"there are: {', '.join(names) or 'none'}"
            raise KeyError(f"there is no object '{key}'; {hint}")
        return found

    def __contains__(self, key: object) -> bool:
        return self._named(key) is not None if isinstance(key, str) else key in self._objects

    def __len__(self) -> int:
        return len(self._objects)

    def __iter__(self) -> Iterator[T]:
        return iter(self._objects)

    def get(self, name: str, default: _D | None = None) -> T | _D | None:
        """Return the object of that name, or ``default``."""
        return self._named(name) or default

    def keys(self) -> list[str]:
        """Return the names."""
        return [obj.name for obj in self._objects]

    def __repr__(self) -> str:
        return repr([obj.name for obj in self._objects])
