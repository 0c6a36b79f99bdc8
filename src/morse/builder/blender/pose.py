"""Positions and angles of scene objects that can be changed in place: ``robot.location.x = 2``."""

from __future__ import annotations

from typing import Any

from morse.builder.errors import checks
from morse.mathutils import Euler, Vector


class LiveVector(Vector):
    """Three numbers of a node, metres or factors; assigning items changes the node."""

    __slots__ = ("_what",)

    def __init__(self, numbers: list[float], what: str) -> None:
        self._items = numbers
        self._what = what

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, _checked(value, self._what))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (Vector, Euler, list, tuple)) and list(self) == list(other)

    __hash__ = Vector.__hash__

    def copy(self) -> Vector:  # type: ignore[override]
        """A copy of the numbers, independent of the node."""
        return Vector(self._items)

    __copy__ = copy  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, object]) -> Vector:  # type: ignore[override]
        return self.copy()


class LiveEuler(Euler):
    """Angles of a node in radians, XYZ order; assigning items changes the node."""

    __slots__ = ("_what",)

    def __init__(self, numbers: list[float], what: str) -> None:
        self._items = numbers
        self._order = "XYZ"
        self._what = what

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, _checked(value, self._what))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (Vector, Euler, list, tuple)) and list(self) == list(other)

    __hash__ = Euler.__hash__

    def copy(self) -> Euler:  # type: ignore[override]
        """A copy of the angles, independent of the node."""
        return Euler(self._items)

    __copy__ = copy  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, object]) -> Euler:  # type: ignore[override]
        return self.copy()


def _checked(value: object, what: str) -> Any:
    if hasattr(value, "__iter__") and not isinstance(value, str):
        return [checks.number(item, what) for item in value]
    return checks.number(value, what)
