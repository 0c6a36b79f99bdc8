"""Plots of sensor data over time, as SVG."""

from __future__ import annotations

import math
from html import escape

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 260, 60, 150, 14, 34
_COLOURS = ("#1f7a70", "#b4560f", "#3b5bb5", "#8a3b8f", "#6b6b1f", "#555555")
_FONT = 'font-family="sans-serif" font-size="12"'
_MOST, _POINTS = 6, 160


def plot(said: list[dict[str, float]]) -> str:
    """The plots of some fields; empty if there is none.

    Args:
        said: one dictionary per measurement, with ``timestamp``, s.
    """
    names = [
        name for name in said[-1] if name != "timestamp" and all(math.isfinite(row.get(name, math.nan)) for row in said)
    ]
    moving = [name for name in names if max(row[name] for row in said) - min(row[name] for row in said) > 1e-9]
    shown = (moving or names)[:_MOST]
    if not shown:
        return ""
    rows = said[:: max(1, len(said) // _POINTS)]
    values = [row[name] for row in rows for name in shown]
    low, high = min(values), max(values)
    if high - low < 1e-9:
        low, high = low - 1.0, high + 1.0
    first, last = rows[0]["timestamp"], rows[-1]["timestamp"]

    def x(time: float) -> float:
        return LEFT + (time - first) / max(last - first, 1e-9) * (WIDTH - LEFT - RIGHT)

    def y(value: float) -> float:
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" {_FONT}>',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
        f'<path d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}" fill="none" stroke="#888888"/>',
        *(f'<text x="{LEFT - 6}" y="{y(v) + 4:.0f}" text-anchor="end">{v:.4g}</text>' for v in (low, high)),
        *(
            f'<text x="{x(t):.0f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{t:.1f} s</text>'
            for t in (first, last)
        ),
    ]
    for number, name in enumerate(shown):
        points = " ".join(f"{x(row['timestamp']):.1f},{y(row[name]):.1f}" for row in rows)
        parts.append(f'<polyline points="{points}" fill="none" stroke="{_COLOURS[number]}" stroke-width="1.5"/>')
        place = f'x="{WIDTH - RIGHT + 10}" y="{TOP + 12 + 18 * number}"'
        parts.append(f'<text {place} fill="{_COLOURS[number]}">{escape(name)}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"
