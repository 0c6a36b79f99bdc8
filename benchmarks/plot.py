"""Plots the results as SVG: speed by the number of robots, for MORSE and other simulators."""

from __future__ import annotations

import math
from collections import defaultdict
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from benchmarks.result import Result

_WIDTH, _HEIGHT = 720, 440
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 150, 40, 50
_COLORS = ("#d1495b", "#00798c", "#edae49", "#30638e", "#6a4c93", "#7fb069", "#8d6e63")

#: labels of programs
_NAMES = {
    "morse": "MORSE",
    "mujoco": "bare MuJoCo loop",
    "pybullet": "PyBullet",
    "sapien": "SAPIEN",
    "irsim": "ir-sim",
    "pyrobosim": "PyRoboSim",
}

Lines = dict[str, list[tuple[float, float]]]


def speed_lines(results: Iterable[Result], benchmarks: Sequence[str] = ("growth", "W1")) -> Lines:
    """Real-time factors of robots with scanners, by simulator: pairs of number of robots and factor, ascending."""
    points: dict[str, dict[float, float]] = defaultdict(dict)
    for result in results:
        if result.benchmark in benchmarks and result.details.get("sensors") == "scan":
            for name, factor in {"morse": result.details["morse"], **result.peers}.items():
                points[name].setdefault(result.details["count"], factor)
    return {name: sorted(values.items()) for name, values in points.items()}


def draw(
    lines: Lines,
    title: str = "Real-time factor by number of robots (pose 60 Hz, 181 rays 10 Hz)",
    across_label: str = "robots",
) -> str:
    """The plot: both axes are logarithmic.

    Raises:
        ValueError: there is nothing to plot.
    """
    xs = [x for line in lines.values() for x, _ in line]
    ys = [y for line in lines.values() for _, y in line]
    if not xs:
        raise ValueError("no number of robots was measured: there is nothing to plot")
    across = _Axis(xs, _LEFT, _WIDTH - _RIGHT)
    up = _Axis(ys, _HEIGHT - _BOTTOM, _TOP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" font-family="sans-serif" '
        f'font-size="12"><rect width="{_WIDTH}" height="{_HEIGHT}" fill="white"/>',
        _text(_WIDTH / 2 - 40, 22, title, "middle", 14),
    ]
    for power in across.powers():
        x = across(power)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}" stroke="#ddd"/>')
        parts.append(_text(x, _HEIGHT - _BOTTOM + 18, f"{power:g}", "middle"))
    for power in up.powers():
        y = up(power)
        parts.append(f'<line x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        parts.append(_text(_LEFT - 8, y + 4, f"{power:g}", "end"))
    parts.append(_text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 12, across_label, "middle"))
    for number, (name, line) in enumerate(lines.items()):
        color = _COLORS[number % len(_COLORS)]
        places = [(across(x), up(y)) for x, y in line]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        width = 4 if name == "morse" else 2
        parts.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width}"/>')
        parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{color}"/>' for x, y in places]
        parts.append(_text(_WIDTH - _RIGHT + 28, _TOP + 12 + 20 * number, _NAMES.get(name, name), "start"))
        parts.append(f'<circle cx="{_WIDTH - _RIGHT + 18}" cy="{_TOP + 8 + 20 * number}" r="5" fill="{color}"/>')
    return "\n".join([*parts, "</svg>\n"])


class _Axis:
    def __init__(self, values: Sequence[float], start: float, end: float) -> None:
        self._low = math.floor(math.log10(min(values)))
        self._high = max(math.ceil(math.log10(max(values))), self._low + 1)
        self._start, self._end = start, end

    def powers(self) -> list[float]:
        return [10.0**power for power in range(self._low, self._high + 1)]

    def __call__(self, value: float) -> float:
        share = (math.log10(value) - self._low) / (self._high - self._low)
        return self._start + share * (self._end - self._start)


def _text(x: float, y: float, text: str, anchor: str, size: int = 12) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">{escape(text)}</text>'
