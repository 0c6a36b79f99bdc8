"""Colours."""

from __future__ import annotations

import colorsys
from typing import TYPE_CHECKING, ClassVar, SupportsFloat

from morse.mathutils.sequence import FloatSequence, floats, is_number, rounded

if TYPE_CHECKING:
    from collections.abc import Iterable


class Color(FloatSequence):
    """Red, green and blue, 0 to 1; also accessible as hue, saturation and value."""

    __slots__ = ()
    _sizes: ClassVar[tuple[int, int]] = (3, 3)

    def __init__(self, values: Iterable[SupportsFloat] = (0.0, 0.0, 0.0)) -> None:
        self._items = floats(values, "Color", 3, 3)

    def __repr__(self) -> str:
        return f"Color(({', '.join(map(rounded, self._items))}))"

    @property
    def r(self) -> float:
        """Red."""
        return self._items[0]

    @r.setter
    def r(self, value: float) -> None:
        self[0] = value

    @property
    def g(self) -> float:
        """Green."""
        return self._items[1]

    @g.setter
    def g(self, value: float) -> None:
        self[1] = value

    @property
    def b(self) -> float:
        """Blue."""
        return self._items[2]

    @b.setter
    def b(self, value: float) -> None:
        self[2] = value

    @property
    def hsv(self) -> tuple[float, float, float]:
        """Hue, saturation and value, each 0 to 1."""
        red, green, blue = self._items
        return colorsys.rgb_to_hsv(red, green, blue)

    @hsv.setter
    def hsv(self, values: Iterable[float]) -> None:
        hue, saturation, value = floats(values, "Color.hsv", 3, 3)
        self._assign(colorsys.hsv_to_rgb(hue, saturation, value))

    @property
    def h(self) -> float:
        """Hue."""
        return self.hsv[0]

    @h.setter
    def h(self, value: float) -> None:
        self.hsv = (value, *self.hsv[1:])

    @property
    def s(self) -> float:
        """Saturation."""
        return self.hsv[1]

    @s.setter
    def s(self, value: float) -> None:
        hue, _, brightness = self.hsv
        self.hsv = (hue, value, brightness)

    @property
    def v(self) -> float:
        """Value."""
        return self.hsv[2]

    @v.setter
    def v(self, value: float) -> None:
        self.hsv = (*self.hsv[:2], value)

    def __add__(self, other: Color) -> Color:
        if not isinstance(other, Color):
            return NotImplemented
        return Color._wrap([a + b for a, b in zip(self._items, other._items, strict=True)])

    def __sub__(self, other: Color) -> Color:
        if not isinstance(other, Color):
            return NotImplemented
        return Color._wrap([a - b for a, b in zip(self._items, other._items, strict=True)])

    def __mul__(self, other: float) -> Color:
        if not is_number(other):
            return NotImplemented
        return Color._wrap([a * float(other) for a in self._items])

    def __rmul__(self, other: float) -> Color:
        return self * other if is_number(other) else NotImplemented

    def __truediv__(self, other: float) -> Color:
        if not is_number(other):
            return NotImplemented
        return Color._wrap([a / float(other) for a in self._items])
