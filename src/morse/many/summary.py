"""The summary of a study as a web page, which needs no other file."""

from __future__ import annotations

import math
from collections import defaultdict
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.many.ledger import write_whole
from morse.many.plots import histogram, scatter
from morse.many.run import RESERVED, signature

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from morse.many.table import Table
    from morse.many.values import Row

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
