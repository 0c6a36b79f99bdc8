"""What a search leaves in its folder: a page with tables and maps, tests, JUnit, and pages that play the failures."""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import subprocess
import sys
from html import escape
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from morse.core.reports.quoting import escaped
from morse.many import Table
from morse.plugins.falsify.campaign import kinds_of, point_of, shown
from morse.plugins.falsify.requirements import VERDICTS
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from morse.plugins.falsify.campaign import Failure, Found
    from morse.plugins.falsify.space import Axis

#: the files of a folder
PAGE, TABLE, JUNIT = "report.html", "runs.csv", "junit.xml"
#: number of pages that play a failure, and wall-clock time to write one, s
_MOST_PAGES, _PATIENCE = 10, 300.0
#: cells of a map along each parameter; points and maps of a page
_CELLS, _MOST_POINTS, _MOST_MAPS = 10, 3000, 15
_WIDTH, _HEIGHT, _LEFT, _BOTTOM = 320, 240, 52, 34
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1100px; padding: 0 1em; color: #222;
       background: #fff } svg { margin: 6px } table { border-collapse: collapse }
td, th { border-bottom: 1px solid #ddd; padding: 3px 12px 3px 0; text-align: left; vertical-align: top }
svg text { font-size: 10px; text-anchor: middle; fill: #555 } svg .left { text-anchor: end }
svg .axis { fill: none; stroke: #888 } .passes { fill: #3b7dd8; fill-opacity: .35 }
.fails { fill: #d33; fill-opacity: .7 } .smallest { fill: none; stroke: #000; stroke-width: 2 }
.remark { background: #fff4d6; padding: 6px 10px } code { background: #f3f3f3; padding: 1px 4px }
"""


def write(found: Found) -> None:
    """Write everything that can be read: the page, the table, JUnit, the tests, and pages that play failures."""
    folder = found.folder
    for failure in found.failures[:_MOST_PAGES]:
        _play(folder, failure)
    Table(found.rows, folder, [axis.name for axis in found.scenario.space.axes if axis.name != "seed"]).to_csv(
        folder / TABLE
    )
    write_whole(folder / PAGE, "\n".join(_page(found)))
    write_whole(folder / JUNIT, "\n".join(_junit(found)))
    for path in folder.glob("test_*.py"):
        if path.is_file() and not path.is_symlink() and path.read_text("utf-8", "replace").startswith(_MARK):
            path.unlink()
    if found.failures:
        write_whole(folder / f"test_{_word(found.scenario.file.stem)}.py", "\n".join(_tests(found)))


def _play(folder: Path, failure: Failure) -> None:
    """Write a page that plays a recording anywhere."""
    if not failure.recording:
        return
    page = f"{Path(failure.recording).stem}.html"
    if not (folder / page).exists():
        words = [sys.executable, "-P", "-m", "morse", "export", failure.recording, "--html", page]
        try:
            done = subprocess.run(words, cwd=folder, capture_output=True, timeout=_PATIENCE, check=False)
        except (OSError, subprocess.SubprocessError):
            return
        if done.returncode:
            return
    failure.page = page


# -- coverage ------------------------------------------------------------------------------


def coverage(found: Found) -> float:
    """The share of the cells of the space, for each pair of free parameters, that have a run."""
    axes = found.scenario.space.free
    cells, reached = 0, 0
    points = [[_cell(axis, row) for axis in axes] for row in found.rows]
    groups = [*combinations(range(len(axes)), 2)] if len(axes) > 1 else [(0,)] * len(axes)
    for group in groups:
        cells += math.prod(min(_CELLS, len(axes[index].values) or _CELLS) for index in group)
        reached += len({tuple(point[index] for index in group) for point in points})
    return reached / cells if cells else 1.0


def _cell(axis: Axis, row: dict[str, Any]) -> int:
    count = min(_CELLS, len(axis.values) or _CELLS)
    return min(count - 1, int(axis.place(row["seed"] if axis.name == "seed" else row[axis.name]) * count))


# -- the page ------------------------------------------------------------------------------


def _page(found: Found) -> list[str]:
    scenario, rows = found.scenario, found.rows
    failed = sum(bool(kinds_of(row)) for row in rows)
    all_cases = ": all cases there are" if found.is_complete else ""
    lines = [
        "<!doctype html><meta charset='utf-8'><title>Falsification</title>",
        f"<style>{_STYLE}</style><h1>{escape(scenario.file.name)}</h1>",
        f"<p>{len(rows):,} runs{all_cases} in {found.spent:,.0f} s, {failed:,} failed in {len(found.failures)} ways; "
        f"{coverage(found):.0%} of the cells of pairs of parameters were visited. "
        f"<a href='{TABLE}'>All runs</a>.</p>",
        *(f"<p class='remark'>{escape(remark)}</p>" for remark in found.remarks),
    ]
    lines += ["<h2>Failures</h2>"] if found.failures else ["<h2>Nothing has failed</h2>"]
    for number, failure in enumerate(found.failures, 1):
        lines += _failure(number, failure)
    lines.append(
        "<h2>Requirements</h2><table><tr><th>requirement<th>runs<th>violated<th>lowest<th>median"
        "<th>with the defaults</tr>"
    )
    for one in scenario.requirements:
        verdicts = [row[VERDICTS][one.name] for row in rows if not row["error"] and one.name in row.get(VERDICTS, {})]
        values = sorted(verdict[1] for verdict in verdicts if verdict[1] is not None)
        default = next(
            (row[VERDICTS][one.name][1] for row in rows if _is_default(found, row) and not row["error"]), None
        )
        numbers = (values[0], values[len(values) // 2]) if values else (math.nan, math.nan)
        lines.append(
            f"<tr><td><code>{escape(one.name)}</code><br>{escape(one.where)}<td>{len(verdicts):,}"
            f"<td>{sum(not verdict[0] for verdict in verdicts):,}<td>{numbers[0]:.4g}<td>{numbers[1]:.4g}"
            f"<td>{'' if default is None else f'{default:.4g}'}</tr>"
        )
    lines.append("</table><p>The numbers say how far a requirement is from being violated; below 0 it is.</p>")
    lines += ["<h2>Maps</h2>", *maps(found)]
    return lines


def _is_default(found: Found, row: dict[str, Any]) -> bool:
    return point_of(found.scenario, row) == found.scenario.space.defaults


def _failure(number: int, failure: Failure) -> list[str]:
    links = []
    if failure.page:
        links.append(f"<a href='{escape(failure.page)}'>play it</a>")
    if failure.recording:
        links.append(f"<code>morse replay {escape(failure.recording)}</code>")
    if failure.others:
        links.append(f"<b>it does not repeat</b>: <code>{escape(failure.others)}</code> is another recording")
    lines = [
        f"<h3>{number}. {escape(failure.kind)}</h3>",
        f"<p>{'<br>'.join(escape(line) for line in failure.what)}</p>",
        f"<p>{failure.runs:,} runs have failed so. {'; '.join(links)}</p>",
        "<table><tr><th>parameter<th>smallest case<th>still passes at</tr>",
    ]
    for name, value in failure.parameters.items():
        boundary = failure.boundaries.get(name)
        passes = "" if boundary is None else escape(shown(boundary.passes))
        lines.append(f"<tr><td>{escape(name)}<td>{escape(shown(value))}<td>{passes}</tr>")
    return [*lines, "</table>"]


# -- maps ----------------------------------------------------------------------------------


def maps(found: Found) -> list[str]:
    """A picture for each pair of free parameters, as SVG: where runs pass and fail, and the smallest cases."""
    axes = found.scenario.space.free
    pairs: list[tuple[Axis, Axis | None]] = [*combinations(axes, 2)] if len(axes) > 1 else [(a, None) for a in axes]

    def weight(pair: tuple[Axis, Axis | None]) -> int:
        # pairs that matter for failures come first
        return -sum(axis.name in failure.boundaries for failure in found.failures for axis in pair if axis is not None)

    return [_map(found, *pair) for pair in sorted(pairs, key=weight)[:_MOST_MAPS]]


def _map(found: Found, x: Axis, y: Axis | None) -> str:
    def across(point: dict[str, Any]) -> float:
        return _LEFT + x.place(point[x.name]) * (_WIDTH - _LEFT - 8)

    def up(point: dict[str, Any]) -> float:
        return 8 + (0.5 if y is None else 1.0 - y.place(point[y.name])) * (_HEIGHT - _BOTTOM - 8)

    label = "" if y is None else y.name
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" role="img">',
        f"<title>{escape(x.name)}, {escape(label)}</title>",
        f'<path class="axis" d="M{_LEFT},8 V{_HEIGHT - _BOTTOM} H{_WIDTH - 8}"/>',
        f'<text x="{(_WIDTH + _LEFT) / 2:g}" y="{_HEIGHT - 4}">{escape(x.name)}</text>',
        f'<text x="12" y="{_HEIGHT / 2:g}" transform="rotate(-90 12 {_HEIGHT / 2:g})">{escape(label)}</text>',
    ]
    for place in (0.0, 0.5, 1.0):
        value = escape(shown(x.value(place))[:12])
        parts.append(f'<text x="{_LEFT + place * (_WIDTH - _LEFT - 8):g}" y="{_HEIGHT - _BOTTOM + 13}">{value}</text>')
        if y is not None:
            height = 11 + (1.0 - place) * (_HEIGHT - _BOTTOM - 8)
            parts.append(
                f'<text class="left" x="{_LEFT - 4}" y="{height:g}">{escape(shown(y.value(place))[:8])}</text>'
            )
    rows = sorted(found.rows[-_MOST_POINTS:], key=lambda row: bool(kinds_of(row)))
    for row in rows:
        point = point_of(found.scenario, row)
        name = "fails" if kinds_of(row) else "passes"
        parts.append(f'<circle class="{name}" cx="{across(point):.1f}" cy="{up(point):.1f}" r="2.5"/>')
    for failure in found.failures:
        point = failure.parameters
        parts.append(f'<circle class="smallest" cx="{across(point):.1f}" cy="{up(point):.1f}" r="5"/>')
    return "".join([*parts, "</svg>"])


# -- for other programs --------------------------------------------------------------------


def _junit(found: Found) -> list[str]:
    failures = {failure.kind: failure for failure in found.failures}
    names = {one.name: [f for f in failures.values() if one.name in f.row.get(VERDICTS, {})] for one in
             found.scenario.requirements}  # fmt: skip
    cases = []
    used: set[str] = set()
    for name, candidates in names.items():
        own = [one for one in candidates if not one.row[VERDICTS][name][0] and one.kind.startswith(name)]
        used.update(one.kind for one in own)
        cases.append((name, own))
    cases += [(failure.kind, [failure]) for failure in found.failures if failure.kind not in used]
    count = sum(bool(own) for _, own in cases)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<testsuite name={_attribute(found.scenario.file.stem)} tests="{len(cases)}" failures="{count}" errors="0" '
        f'time="{found.spent:.1f}">',
    ]
    for name, own in cases:
        head = f'  <testcase classname="falsify" name={_attribute(name)}'
        if not own:
            lines.append(f"{head}/>")
            continue
        given = "; ".join(str(one) for one in own)
        text = escape(_clean("\n".join(line for one in own for line in one.what)))
        lines.append(f"{head}><failure message={_attribute(given)}>{text}</failure></testcase>")
    return [*lines, "</testsuite>"]


def _clean(text: str) -> str:
    """Text without what XML does not allow."""
    return "\n".join(escaped(line) for line in text.split("\n"))


def _attribute(text: str) -> str:
    return quoteattr(_clean(text))


_MARK = '"""Written by morse falsify'


def _tests(found: Found) -> list[str]:
    scenario = found.scenario
    path = os.path.relpath(scenario.file.resolve(), found.folder.resolve())
    lines = [
        f"{_MARK}: each case fails until the software is fixed, and passes from then on.",
        "",
        "The next search in this folder writes it again: copy what you keep.",
        '"""',
        "",
        "from pathlib import Path",
        "",
        "from morse.many import read_scenario",
        "",
        f"scenario = read_scenario(Path(__file__).parent / {path!r}, {scenario.name()!r})",
        "",
    ]
    seen: dict[str, int] = {}
    for failure in found.failures:
        word = _word(failure.kind)
        seen[word] = seen.get(word, 0) + 1
        name = word if seen[word] == 1 else f"{word}_{seen[word]}"
        parameters = {key: value for key, value in failure.parameters.items() if key != "seed"}
        lines += [
            "",
            f"def test_{name}():",
            *(f"    # {_comment(line)}" for line in failure.what),
            f"    scenario.check({_literal(parameters)}, seed={failure.parameters['seed']!r})",
            "",
        ]
    return lines


def _comment(text: str) -> str:
    return escaped(text)[:110]


def _literal(parameters: dict[str, Any]) -> str:
    """Plain data as Python."""
    return repr(json.loads(json.dumps(parameters)))


def _word(text: str) -> str:
    """A part of the name of a function."""
    words = re.sub(r"[^a-z0-9]+", "_", text.lower().replace("<", " below ").replace(">", " above ")).strip("_")
    return words[:60] or "case"


def summary(found: Found) -> list[str]:
    """What a terminal shows at the end."""
    lines = [f"{len(found.rows):,} runs, {found.spent:.0f} s, {coverage(found):.0%} of the space visited."]
    lines += [f"Remark: {remark}" for remark in found.remarks]
    for failure in found.failures:
        lines.append(str(failure))
        lines += [f"    {line}".replace("\n", "\n    ") for line in failure.what]
        for name, boundary in failure.boundaries.items():
            lines.append(f"    {name}: passes at {shown(boundary.passes)}, fails at {shown(boundary.fails)}")
        if failure.recording:
            with contextlib.suppress(ValueError):
                lines.append(f"    morse replay {os.path.relpath(found.folder / failure.recording)}")
    return lines
