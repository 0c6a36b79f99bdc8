"""The pictures of the page, as SVG."""

from __future__ import annotations

import math

import mechanics
import sensing


def _plot(points: list[tuple[float, float]], line: list[tuple[float, float]], words: list[tuple[int, int, str]]) -> str:
    """Draw measured points and a line, at places in the picture."""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in line)
    return "\n".join(
        [
            '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 290" font-family="sans-serif" font-size="13">',
            '<rect width="640" height="290" fill="#ffffff"/>',
            '<path d="M60 20V250H560" fill="none" stroke="#888888"/>',
            *(f'<text x="{x}" y="{y}">{word}</text>' for x, y, word in words),
            f'<polyline points="{path}" fill="none" stroke="#1f7a70" stroke-width="1.5"/>',
            *(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="#b4560f"/>' for x, y in points),
            "</svg>\n",
        ]
    )


def arc() -> str:
    """The path of a thrown ball."""

    def at(x: float, z: float) -> tuple[float, float]:
        return 60 + x * 120, 250 - z * 90

    times = [tick / 120.0 for tick in range(121)]
    line = [at(4.0 * t, 1.0 + 5.0 * t - mechanics.G * t * t / 2.0) for t in times]
    dots = [at(x, z) for _, x, z in mechanics.flight()[::5]]
    return _plot(dots, line, [(570, 254, "x"), (534, 268, "4 m"), (44, 24, "z"), (20, 164, "1 m")])


def allan() -> str:
    """The Allan deviation of a gyroscope over time, with logarithmic axes."""

    def at(time: float, deviation: float) -> tuple[float, float]:
        return 240 + math.log10(time) * 100, 70 - (math.log10(deviation) + 1.0) * 80

    dots = [at(*pair) for pair in sensing.deviations()]
    line = [at(time, 0.014 / math.sqrt(time)) for time in (1 / 60, 30.0)]
    words = [(520, 268, "time"), (230, 268, "1 s"), (330, 268, "10 s"), (6, 74, "0.1 °/s"), (2, 154, "0.01 °/s")]
    return _plot(dots, line, words)
