"""The children of an object, found by number or by name."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, overload

if TYPE_CHECKING:
    from morse.physics.gameobject import GameObject


class ObjectList(Sequence["GameObject"]):
    """A list of objects that can also be asked for a name.

    A name matches exactly, or as it stands in the model file: the second robot of a kind has
    its ``left_eye`` too, although the scene calls it ``left_eye.001``.
    """

    def __init__(self, objects: list[GameObject]) -> None:
        self._objects = objects

    def _named(self, name: str) -> GameObject | None:
        exact = next((obj for obj in self._objects if obj.name == name), None)
        return exact or next((obj for obj in self._objects if obj.node.plain_name == name), None)

    @overload
    def __getitem__(self, key: int | str) -> GameObject: ...
    @overload
    def __getitem__(self, key: slice) -> list[GameObject]: ...
    def __getitem__(self, key: int | str | slice) -> GameObject | list[GameObject]:
        if not isinstance(key, str):
            return self._objects[key]
        found = self._named(key)
        if found is None:
            names = [obj.node.plain_name for obj in self._objects]
            close = difflib.get_close_matches(key, names, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"there are: {', '.join(names) or 'none'}"
            raise KeyError(f"no object '{key}' here; {hint}")
        return found

    def __contains__(self, key: object) -> bool:
        return self._named(key) is not None if isinstance(key, str) else key in self._objects

    def __len__(self) -> int:
        return len(self._objects)

    def __iter__(self) -> Iterator[GameObject]:
        return iter(self._objects)

    def get(self, name: str, default: GameObject | None = None) -> GameObject | None:
        """The object of that name, or ``default``."""
        return self._named(name) or default

    def keys(self) -> list[str]:
        """The names."""
        return [obj.name for obj in self._objects]

    def __repr__(self) -> str:
        return repr([obj.name for obj in self._objects])
