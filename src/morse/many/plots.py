"""Plots as SVG, without a library."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_WIDTH, _HEIGHT, _LEFT, _BOTTOM = 340, 200, 48, 34
_MOST_POINTS = 2000
#: greatest value on an axis, and smallest length of an axis: absolute, and as a share of its values
_GREATEST, _LEAST, _SHARE = 1e300, 1e-300, 1e-9


class Frame:
    """The axes of a plot.

    Args:
        x: smallest and largest value, left and right.
        y: likewise, bottom and top.
    """

    def __init__(self, title: str, x: tuple[float, float], y: tuple[float, float], x_label: str, y_label: str) -> None:
        self._x, self._y = _widened(x), _widened(y)
        self._parts = [
            f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" height="{_HEIGHT}" role="img">',
            f"<title>{escape(title)}</title>",
            f'<path class="axis" d="M{_LEFT},8 V{_HEIGHT - _BOTTOM} H{_WIDTH - 8}"/>',
            f'<text x="{_WIDTH / 2:g}" y="{_HEIGHT - 4}" class="label">{escape(x_label)}</text>',
            f'<text x="12" y="{_HEIGHT / 2:g}" class="label" transform="rotate(-90 12 {_HEIGHT / 2:g})">'
            f"{escape(y_label)}</text>",
        ]
        for value in _ticks(*self._x):
            self._parts.append(f'<text x="{self.across(value):.1f}" y="{_HEIGHT - _BOTTOM + 13}">{value:g}</text>')
        for value in _ticks(*self._y):
            self._parts.append(f'<text x="{_LEFT - 4}" y="{self.up(value) + 3:.1f}" class="left">{value:g}</text>')

    def across(self, x: float) -> float:
        """The horizontal place of a value, px."""
        low, high = self._x
        return _LEFT + (x - low) / (high - low) * (_WIDTH - 8 - _LEFT)

    def up(self, y: float) -> float:
        """The vertical place of a value, px."""
        low, high = self._y
        return _HEIGHT - _BOTTOM - (y - low) / (high - low) * (_HEIGHT - _BOTTOM - 8)

    def add(self, part: str) -> None:
        """Add an element."""
        self._parts.append(part)

    def line(self, x: Sequence[float], y: Sequence[float], style: str = "line") -> None:
        """Add a line through points."""
        points = " ".join(f"{self.across(a):.1f},{self.up(b):.1f}" for a, b in zip(x, y, strict=True))
        self.add(f'<polyline class="{style}" points="{points}"/>')

    def __str__(self) -> str:
        return "\n".join([*self._parts, "</svg>"])


def histogram(name: str, values: NDArray[np.float64]) -> str:
    """Return the distribution of a result."""
    limits = _widened((values.min(), values.max()))
    values = np.clip(values, *limits)
    counts, edges = np.histogram(values, bins=min(30, max(5, math.isqrt(len(values)))), range=limits)
    frame = Frame(f"distribution of {name}", (edges[0], edges[-1]), (0.0, float(counts.max())), name, "runs")
    for count, left, right in zip(counts.tolist(), edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        x, top = frame.across(left), frame.up(count)
        width, height = frame.across(right) - x - 1, frame.up(0.0) - top
        frame.add(f'<rect x="{x:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}"/>')
    return str(frame)


def scatter(x_name: str, y_name: str, x: NDArray[np.float64], y: NDArray[np.float64]) -> str:
    """Return a result over a parameter, with the means."""
    x, y = np.clip(x, -_GREATEST, _GREATEST), np.clip(y, -_GREATEST, _GREATEST)
    frame = Frame(f"{y_name} over {x_name}", (x.min(), x.max()), (y.min(), y.max()), x_name, y_name)
    for a, b in list(zip(x.tolist(), y.tolist(), strict=True))[:: max(1, len(x) // _MOST_POINTS)]:
        frame.add(f'<circle cx="{frame.across(a):.1f}" cy="{frame.up(b):.1f}" r="2"/>')
    places = np.unique(x)
    if len(places) > 12:
        edges = np.quantile(x, np.linspace(0.0, 1.0, 9))
        groups = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, 7)
    else:
        groups = np.searchsorted(places, x)
    kinds = np.unique(groups)
    frame.line([float(x[groups == k].mean()) for k in kinds], [float(y[groups == k].mean()) for k in kinds])
    return str(frame)


def _widened(limits: tuple[float, float]) -> tuple[float, float]:
    """The ends of an axis, which bins and ticks can divide: neither too close together nor too far apart."""
    low, high = max(float(limits[0]), -_GREATEST), min(float(limits[1]), _GREATEST)
    low, high = min(low, _GREATEST), max(high, -_GREATEST)
    least = max(_LEAST, _SHARE * max(abs(low), abs(high)))
    return (low, high) if high - low > least else (low - max(0.5, least), high + max(0.5, least))


def _ticks(low: float, high: float) -> list[float]:
    raw = (high - low) / 4.0
    step = 10.0 ** math.floor(math.log10(raw))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * step >= raw * 0.999)
    first = math.ceil(low / step - 1e-9)
    return [round((first + k) * step, 12) for k in range(int((high - first * step) / step + 1e-9) + 1)]
