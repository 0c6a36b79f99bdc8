"""The summary of a study as a web page with plots, which needs no other file."""

from __future__ import annotations

import math
from collections import defaultdict
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.many.run import RESERVED, signature
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from morse.many.results import Table
    from morse.many.values import Row

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


SUMMARY = "summary.html"
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1100px; padding: 0 1em; color: #222;
       background: #fff } svg { margin: 6px } table { border-collapse: collapse }
td, th { border-bottom: 1px solid #ddd; padding: 3px 12px 3px 0; text-align: left; vertical-align: top }
svg text { font-size: 10px; text-anchor: middle; fill: #555 } svg .left { text-anchor: end }
svg .axis { fill: none; stroke: #888 } svg rect, svg circle { fill: #3b7dd8; fill-opacity: .45 }
svg .line { fill: none; stroke: #c33; stroke-width: 2 } code { background: #f3f3f3; padding: 1px 4px }
"""
#: runs that are named of each kind of failure, and kinds that are listed
_MOST_NAMED, _MOST_KINDS = 5, 200


def write_summary(table: Table, total: int) -> Path:
    """Write ``summary.html`` into the folder of a study.

    Args:
        total: number of runs of the study.
    """
    page = "\n".join(_page(table, total))
    path = table.folder / SUMMARY
    write_whole(path, page)
    return path


def _page(table: Table, total: int) -> list[str]:
    count, failures = len(table), len(table.failures)
    wall, ticks = sum(row["wall"] for row in table), sum(row["ticks"] for row in table)
    lines = [
        "<!doctype html><meta charset='utf-8'><title>Study</title>",
        f"<style>{_STYLE}</style><h1>Study in {escape(table.folder.name)}</h1>",
        f"<p>{count:,} of {total:,} runs are done, {failures:,} failed; {ticks:,} ticks in {wall:,.1f} s.</p>",
    ]
    results = [name for name in table.columns if name not in RESERVED and name not in table.axes]
    numbers = {name: values for name in results if (values := _numbers(table[name])) is not None}
    if numbers:
        lines.append("<h2>Results</h2><table><tr><th><th>mean<th>deviation<th>least<th>greatest</tr>")
        for name, values in numbers.items():
            there = values[np.isfinite(values)]
            cells = (there.mean(), there.std(), there.min(), there.max())
            lines.append(f"<tr><th>{escape(name)}" + "".join(f"<td>{cell:.4g}" for cell in cells) + "</tr>")
        lines.append("</table>")
        lines += [histogram(name, values[np.isfinite(values)]) for name, values in numbers.items()]
    lines += _by_parameter(table, numbers)
    lines += _failures(table)
    return lines


def _by_parameter(table: Table, numbers: Row) -> list[str]:
    lines = ["<h2>Results by parameter</h2>"] if table.axes and numbers else []
    for parameter in table.axes if numbers else ():
        x = _numbers(table[parameter])
        if x is None or len(np.unique(x)) < 2:
            continue
        for name, y in numbers.items():
            there = np.isfinite(x) & np.isfinite(y)
            if there.any():
                lines.append(scatter(parameter, name, x[there], y[there]))
    return lines


def _failures(table: Table) -> list[str]:
    if not table.failures:
        return []
    kinds: defaultdict[str, list[Row]] = defaultdict(list)
    for row in table.failures:
        kinds[signature(row)].append(row)
    lines = ["<h2>Failures</h2><table><tr><th>runs<th>error<th>such as</tr>"]
    for rows in sorted(kinds.values(), key=len, reverse=True)[:_MOST_KINDS]:
        names = ", ".join(
            f"<a href='{escape(row['recording'])}'>{row['run']}</a>" if row["recording"] else row["run"]
            for row in rows[:_MOST_NAMED]
        )
        where = f"<br><code>{escape(rows[0]['where'])}</code>" if rows[0]["where"] else ""
        lines.append(f"<tr><td>{len(rows)}<td>{escape(rows[0]['error'])}{where}<td>{names}</tr>")
    if len(kinds) > _MOST_KINDS:
        lines.append(f"<tr><td><td>… and {len(kinds) - _MOST_KINDS:,} other errors<td></tr>")
    lines.append("</table><p>A failure is repeated by <code>morse sweep rerun FOLDER RUN STUDY.py</code>.</p>")
    return lines


def _numbers(values: list[Any]) -> NDArray[np.float64] | None:
    """A column as numbers, NaN where a run has none; None if it contains something else, or nothing."""
    if any(value is not None and not isinstance(value, (int, float)) for value in values):
        return None
    array = np.array([math.nan if value is None else float(value) for value in values])
    return array if np.isfinite(array).any() else None
