"""The page of a fit: what was found, how far the simulation is off, and where."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.reports.quoting import short
from morse.plugins.twin.comparison import noise_of, persistence
from morse.plugins.twin.statistics import (
    Trajectory,
    absolute_error,
    allan,
    relative_error,
    rms,
    rotations_of,
    spectrum,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.plugins.twin.comparison import Channel
    from morse.plugins.twin.twin import Fitted

    Floats = NDArray[np.float64]

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP = 340, 190, 52, 30, 22
#: points of a curve, curves of a page, and the longest list of numbers whose items are shown
_POINTS, _MOST_PLOTS, _MOST_ITEMS = 240, 60, 6
#: correlation from which a clock is compared
_CLEAR = 0.3
#: fields of inertial sensors, for which the Allan deviation is usual
_INERTIAL = ("angular_velocity", "linear_acceleration")
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1120px; padding: 0 1em; color: #222;
       background: #fff } svg { margin: 4px } table { border-collapse: collapse }
td, th { border-bottom: 1px solid #ddd; padding: 3px 16px 3px 0; text-align: left; vertical-align: top }
td.n { text-align: right; font-variant-numeric: tabular-nums }
h1 { margin-bottom: 0 }
.lead { font-size: 18px; margin: .3em 0 1em } .unknown { color: #a15c00 }
svg text { font-size: 10px; fill: #555 } svg .title { font-size: 11px; fill: #222 }
svg .axis { fill: none; stroke: #999 }
.before { fill: none; stroke: #bbb } .after { fill: none; stroke: #1f6fd0 } .log { fill: none; stroke: #d33 }
.remark { background: #fff4d6; padding: 5px 10px; margin: 4px 0 }
.key { display: inline-block; width: 22px; height: 3px;
vertical-align: middle; margin: 0 4px 0 14px }
"""


def page(fitted: Fitted) -> str:
    """The page as HTML; it needs no other file."""
    result, twin = fitted.result, fitted.twin
    log = Path(twin.log.path).name
    scene = Path(twin._source).name or "the scene"
    lines = [
        "<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'>",
        f"<title>{escape(short(log))}</title><style>{_STYLE}</style>",
        f"<h1>{escape(short(scene))} against {escape(short(log))}</h1>",
        f"<p class='lead'>{_lead(fitted)}</p>",
    ]
    if result.parameters:
        lines += ["<h2>Parameters</h2>", *_parameters(fitted)]
    sayings = [*result.relations, *result.remarks]
    lines += [f"<p class='remark'>{escape(line)}.</p>" for line in sayings]
    if fitted.manoeuvre is not None:
        lines.append(
            f"<p>A manoeuvre that would tell more: <b>{escape(fitted.manoeuvre.text)}</b>, for 12 s. Expected:</p>"
        )
        lines.append("<table><tr><th>parameter<th>spread afterwards</tr>")
        lines += [
            f"<tr><td>{escape(one.name)}"
            f"<td class='n'>{_number(fitted.manoeuvre.spreads[one.name])} {escape(one.unit)}</tr>"
            for number, one in enumerate(result.parameters)
            if not result.is_known(number)
        ]
        lines.append("</table>")
    lines += [f"<p class='remark'>{escape(short(line, 300))}.</p>" for line in fitted.remarks]
    lines += ["<h2>Sensors</h2>", *_sensors(fitted), *_clocks(fitted), *_trajectories(fitted)]
    lines += ["<h2>Errors over time</h2>", _legend(), *_plots(fitted)]
    lines += ["<h2>The log</h2><table><tr><th>component<th>topic<th>samples<th>fields</tr>"]
    for link in twin.links:
        count = len((twin.commands if link.is_command else fitted.comparison.measured)[link.component].times)
        what = "commands" if link.is_command else ""
        lines.append(
            f"<tr><td>{escape(link.component)} {what}<td>{escape(short(link.topic))}<td class='n'>{count:,}"
            f"<td>{escape(', '.join(map(short, link.sources)))}</tr>"
        )
    lines.append(f"</table><p>{twin.log.form}, {twin.duration:.4g} s; {result.simulations:,} simulations.</p></html>")
    return "\n".join(lines)


def _lead(fitted: Fitted) -> str:
    """The most important sentence."""
    before, after = fitted.errors_before, fitted.errors
    shares = [after[name] / before[name] for name in after if before[name] > 0.0 and math.isfinite(after[name])]
    known = len(fitted.values)
    if not fitted.result.parameters:
        return "Nothing was fitted: the simulation of the scene as it is, compared with the log."
    better = 1.0 - float(np.median(shares)) if shares else 0.0
    fits = f"The errors fall by {better:.0%} (median of all sensors)." if better > 0.005 else "The errors do not fall."
    return f"{known} of {len(fitted.result.parameters)} parameters are known from this log. {fits}"


def _number(value: float) -> str:
    return "unknown" if not math.isfinite(value) else f"{value:.4g}"


def _parameters(fitted: Fitted) -> list[str]:
    result = fitted.result
    lines = ["<table><tr><th>parameter<th>in the scene<th>fitted<th>spread<th>unit<th></tr>"]
    for number, one in enumerate(result.parameters):
        start, value, spread = (float(values[number]) for values in (result.start, result.values, result.spreads))
        if result.is_known(number):
            apart = abs(value - start) / spread if spread > 0.0 else math.inf
            verdict = f"{apart:,.0f} spreads from the scene" if apart >= 3.0 else "as in the scene"
            cells = f"<td class='n'><b>{value:.5g}</b><td class='n'>± {spread:.2g}"
        else:
            verdict, cells = "<span class='unknown'>not known from this log</span>", "<td class='n'>–<td class='n'>"
        lines.append(
            f"<tr><td>{escape(one.name)}<td class='n'>{start:.5g}{cells}<td>{escape(one.unit)}<td>{verdict}</tr>"
        )
    return [*lines, "</table>"]


def _shown(fitted: Fitted) -> list[tuple[int, Channel]]:
    """The channels that are shown: of long lists, the first ones."""
    return [(number, one) for number, one in enumerate(fitted.comparison.channels) if one.item < _MOST_ITEMS]


def _sensors(fitted: Fitted) -> list[str]:
    lines = [
        "<table><tr><th>measured<th>error before<th>error after<th>bias<th>noise<th>samples that share an error"
        "<th>unit</tr>"
    ]
    for number, one in _shown(fitted):
        before, after = fitted.result.before.errors[number], fitted.result.after.errors[number]
        finite = after[np.isfinite(after)]
        if not len(finite):
            continue
        lines.append(
            f"<tr><td>{escape(one.name)}<td class='n'>{rms(before):.4g}<td class='n'><b>{rms(after):.4g}</b>"
            f"<td class='n'>{finite.mean():+.2g}<td class='n'>{noise_of(finite):.3g}"
            f"<td class='n'>{persistence(finite):.1f}<td>{escape(one.unit)}</tr>"
        )
    lines.append(
        "</table><p>Errors are root mean squares of measured minus simulated values. Noise is white noise, from the "
        "second differences. Samples share an error where something is not in the model: 1 for white noise.</p>"
    )
    return lines


def _clocks(fitted: Fitted) -> list[str]:
    lines = []
    for sensor, clock in fitted.comparison.clocks.items():
        if clock.correlation > _CLEAR:
            topic = next(link.topic for link in fitted.twin.links if link.component == sensor)
            latency = fitted.twin.log.series[topic].latency
            more = f"; received {latency:.3f} s after its stamps" if math.isfinite(latency) else ""
            applied = "corrected" if clock.is_applied else "not corrected"
            lines.append(
                f"<tr><td>{escape(sensor)}<td class='n'>{clock.delay:+.3f}<td class='n'>{1e6 * clock.drift:+.0f}"
                f"<td class='n'>{clock.correlation:.2f}<td>{applied}{more}</tr>"
            )
    head = "<h3>Clocks</h3><table><tr><th>sensor<th>later by, s<th>drift, µs/s<th>correlation<th></tr>"
    return [head, *lines, "</table>"] if lines else []


# -- trajectories ----------------------------------------------------------------------------


def trajectories(fitted: Fitted, sensor: str) -> tuple[Trajectory, Trajectory, Trajectory] | None:
    """Measured, simulated before and after the fit, at the same times; None for a sensor without positions."""
    channels = {one.field: number for number, one in enumerate(fitted.comparison.channels) if one.sensor == sensor}
    if not {"x", "y"} <= set(channels):
        return None
    times = fitted.comparison.times(sensor)
    columns: list[dict[str, Floats]] = [{}, {}, {}]
    for name in ("x", "y", "z", "roll", "pitch", "yaw"):
        number = channels.get(name)
        if number is None:
            for column in columns:
                column[name] = np.zeros(len(times))
            continue
        seen = fitted.comparison.values(fitted.comparison.channels[number])
        errors = fitted.result.before.errors[number], fitted.result.after.errors[number]
        for column, values in zip(columns, (seen, seen - errors[0], seen - errors[1]), strict=True):
            column[name] = values
    is_finite = np.isfinite(np.stack([column[name] for column in columns for name in column])).all(axis=0)
    if is_finite.sum() < 3:
        return None
    paths = [
        Trajectory(
            times[is_finite],
            np.stack([column[name][is_finite] for name in ("x", "y", "z")], axis=1),
            rotations_of(*(column[name][is_finite] for name in ("roll", "pitch", "yaw"))),
        )
        for column in columns
    ]
    return paths[0], paths[1], paths[2]


def _trajectories(fitted: Fitted) -> list[str]:
    rows, pictures = [], []
    for sensor in fitted.comparison.measured:
        paths = trajectories(fitted, sensor)
        if paths is None:
            continue
        seen, before, after = paths
        rate = (len(seen.times) - 1) / max(float(seen.times[-1] - seen.times[0]), 1e-9)
        frames = min(max(1, round(rate)), len(seen.times) - 1)
        for name, path in (("before", before), ("after", after)):
            rows.append(
                f"<tr><td>{escape(sensor)}<td>{name}<td class='n'>{rms(absolute_error(path, seen)):.4g}"
                f"<td class='n'>{rms(absolute_error(path, seen, align=True)):.4g}"
                f"<td class='n'>{rms(relative_error(path, seen, frames)):.4g}</tr>"
            )
        curves = [("log", seen), ("before", before), ("after", after)]
        pictures.append(
            _path_plot(sensor, [(name, path.positions[:, 0], path.positions[:, 1]) for name, path in curves])
        )
    if not rows:
        return []
    return [
        "<h3>Trajectories</h3><table><tr><th>sensor<th>the fit<th>APE, m<th>APE aligned, m<th>RPE over 1 s, m</tr>",
        *rows,
        "</table><p>Root mean squares of the absolute and relative pose errors (translation).</p>",
        _legend(log=True),
        *pictures,
    ]


# -- pictures --------------------------------------------------------------------------------


def _legend(*, log: bool = False) -> str:
    names = [("#d33", "log")] if log else []
    names += [("#bbb", "before"), ("#1f6fd0", "after the fit")]
    return (
        "<p>" + "".join(f"<span class='key' style='background:{color}'></span>{name}" for color, name in names) + "</p>"
    )


def _plots(fitted: Fitted) -> list[str]:
    pictures = []
    for number, one in _shown(fitted)[:_MOST_PLOTS]:
        times = fitted.comparison.times(one.sensor)
        before, after = fitted.result.before.errors[number], fitted.result.after.errors[number]
        pictures.append(
            _plot(f"{one.name}, {one.unit or '1'}", [("before", times, before), ("after", times, after)], "s")
        )
    spectra = ["<h2>Spectra of the errors</h2>"]
    deviations = ["<h2>Allan deviations of the errors</h2>"]
    table = []
    for number, one in _shown(fitted)[:_MOST_PLOTS]:
        times, errors = fitted.comparison.times(one.sensor), fitted.result.after.errors[number]
        is_finite = np.isfinite(errors)
        if is_finite.sum() < 100:
            continue
        rate = (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9)
        even = np.interp(
            np.arange(times[is_finite][0], times[is_finite][-1], 1.0 / rate), times[is_finite], errors[is_finite]
        )
        x, y = spectrum(even, rate)
        spectra.append(_plot(f"{one.name}, ({one.unit or '1'})²/Hz", [("after", x, y)], "Hz", log=True))
        found = allan(even, rate) if one.field in _INERTIAL else None
        if found is not None:
            deviations.append(
                _plot(f"{one.name}, {one.unit}", [("after", found.times, found.deviations)], "s", log=True)
            )
            table.append(
                f"<tr><td>{escape(one.name)}<td class='n'>{_positive(found.white)}<td class='n'>{found.instability:.3g}"
                f"<td class='n'>{_positive(found.walk)}<td>{escape(one.unit)}</tr>"
            )
    if table:
        deviations += [
            "<table><tr><th>measured<th>white noise, /√Hz<th>bias instability<th>random walk, /√s<th>unit</tr>",
            *table,
            "</table>",
        ]
    return [*pictures, *(spectra if len(spectra) > 1 else []), *(deviations if table else [])]


def _positive(value: float) -> str:
    return f"{value:.3g}" if value > 0.0 else "–"


def _frame(title: str, x: tuple[float, float], y: tuple[float, float], unit: str, *, log: bool) -> list[str]:
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" role="img">',
        f'<title>{escape(title)}</title><text class="title" x="4" y="12">{escape(title)}</text>',
        f'<path class="axis" d="M{_LEFT},{_TOP} V{_HEIGHT - _BOTTOM} H{_WIDTH - 8}"/>',
    ]
    for share in (0.0, 0.5, 1.0):
        across, up = (low + share * (high - low) for low, high in (x, y))
        if log:
            across, up = 10.0**across, 10.0**up
        place = _LEFT + share * (_WIDTH - _LEFT - 8)
        height = _HEIGHT - _BOTTOM - share * (_HEIGHT - _BOTTOM - _TOP)
        end = f" {unit}" if share == 1.0 else ""
        anchor = "end" if share == 1.0 else "middle"
        lines.append(
            f'<text x="{place:.0f}" y="{_HEIGHT - _BOTTOM + 13}" text-anchor="{anchor}">{across:.3g}{end}</text>'
        )
        lines.append(f'<text x="{_LEFT - 4}" y="{height + 3:.0f}" text-anchor="end">{up:.2g}</text>')
    return lines


def _plot(title: str, curves: Sequence[tuple[str, Floats, Floats]], unit: str, *, log: bool = False) -> str:
    """Curves over time or frequency, as SVG."""
    drawn = []
    for name, x, y in curves:
        is_finite = np.isfinite(y) & ((y > 0.0) & (x > 0.0) if log else True)
        x, y = x[is_finite], y[is_finite]
        if len(x) > 1:
            drawn.append((name, np.log10(x), np.log10(y)) if log else (name, x, y))
    if not drawn:
        return ""
    across = min(float(x.min()) for _, x, _ in drawn), max(float(x.max()) for _, x, _ in drawn)
    up = _limits([y for _, _, y in drawn])
    lines = _frame(title, across, up, unit, log=log)
    for name, x, y in drawn:
        lines.append(f'<path class="{name}" d="{_path(*_thinned(x, y), across, up)}"/>')
    return "".join([*lines, "</svg>"])


def _path_plot(title: str, curves: Sequence[tuple[str, Floats, Floats]]) -> str:
    """Paths on the ground, with the same scale along both axes, as SVG."""
    xs, ys = [curve[1] for curve in curves], [curve[2] for curve in curves]
    x, y = ((min(float(one.min()) for one in some), max(float(one.max()) for one in some)) for some in (xs, ys))
    wide, high = _WIDTH - _LEFT - 8, _HEIGHT - _BOTTOM - _TOP
    scale = max((x[1] - x[0]) / wide, (y[1] - y[0]) / high, 1e-6)
    across = _around(x, scale * wide)
    up = _around(y, scale * high)
    lines = _frame(f"{title}: x and y, m", across, up, "m", log=False)
    for name, one, other in curves:
        step = max(1, len(one) // (4 * _POINTS))
        lines.append(f'<path class="{name}" d="{_path(one[::step], other[::step], across, up)}"/>')
    return "".join([*lines, "</svg>"])


def _around(limits: tuple[float, float], width: float) -> tuple[float, float]:
    middle = 0.5 * (limits[0] + limits[1])
    return middle - 0.5 * width, middle + 0.5 * width


def _limits(values: Sequence[Any]) -> tuple[float, float]:
    low, high = min(float(one.min()) for one in values), max(float(one.max()) for one in values)
    room = 0.05 * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room


def _thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The lowest and the highest value of each part of a long curve."""
    if len(x) <= 2 * _POINTS:
        return x, y
    places = []
    for part in np.array_split(np.arange(len(x)), _POINTS):
        places += sorted({int(part[np.argmin(y[part])]), int(part[np.argmax(y[part])])})
    return x[places], y[places]


def _path(x: Floats, y: Floats, across: tuple[float, float], up: tuple[float, float]) -> str:
    wide, high = _WIDTH - _LEFT - 8, _HEIGHT - _BOTTOM - _TOP
    places = _LEFT + (x - across[0]) / max(across[1] - across[0], 1e-12) * wide
    heights = _HEIGHT - _BOTTOM - (y - up[0]) / max(up[1] - up[0], 1e-12) * high
    return "M" + " ".join(f"{one:.1f},{other:.1f}" for one, other in zip(places, heights, strict=True))
