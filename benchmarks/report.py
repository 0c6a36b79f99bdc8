"""The results as a table and as JSON."""

from __future__ import annotations

import json
import os
import platform
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from benchmarks.plan import Plan
    from benchmarks.result import Result

_HEADS = ("benchmark", "case", "wanted", "reached", "", "others")
_MARKS = {"ok": "[green]ok[/]", "short": "[yellow]short[/]", "FAILED": "[red]FAILED[/]", "": ""}


def table(results: Sequence[Result]) -> Table:
    """A line for each result."""
    made = Table(title="Benchmarks")
    for column in _HEADS:
        made.add_column(column, justify="right" if column in ("wanted", "reached", "") else "left")
    for result in results:
        *start, mark, others = _cells(result)
        made.add_row(*start, _MARKS[mark], others)
    return made


def markdown(results: Sequence[Result], plan: Plan) -> str:
    """The same table in Markdown, with a description of the machine below it."""
    rows = [_HEADS, ("---", "---", "--:", "--:", "---", "---"), *(_cells(result) for result in results)]
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    about = machine()
    clock = "processor time" if plan.processor else "wall-clock time"
    lines += [
        "",
        f"Medians of {plan.repeats}, {clock}: {about['cores']} cores of {about['processor']}, {about['system']}, "
        f"Python {about['python']}, MuJoCo {about['mujoco']}, numpy {about['numpy']}.",
    ]
    return "\n".join(lines) + "\n"


def _cells(result: Result) -> tuple[str, ...]:
    wanted = "" if result.wanted is None else f"{result.wanted.relation} {result.wanted.bound:g}"
    mark = "FAILED" if result.failed else {True: "ok", False: "short", None: ""}[result.is_good]
    others = ", ".join(
        [
            *(f"{name} {_number(value)}" for name, value in result.peers.items()),
            *(f"{name} left out ({why.splitlines()[-1]})" for name, why in result.left_out.items()),
        ]
    )
    if "morse" in result.details:
        others = f"morse {_number(result.details['morse'])}, {others}"
    return result.benchmark, result.case, wanted, _reached(result), mark, result.trouble or others


def _reached(result: Result) -> str:
    return "" if result.value is None else f"{_number(result.value)} {result.unit}"


def _number(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def busy() -> str:
    """A warning if the machine is loaded."""
    if not hasattr(os, "getloadavg"):
        return ""
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    if load < 0.5 * cores:
        return ""
    return f"This machine is busy (load {load:.1f} on {cores} cores): the results will vary, or use --processor."


def machine() -> dict[str, Any]:
    """The machine and the versions of the measurement."""
    return {
        "python": platform.python_version(),
        "system": platform.system(),
        "processor": platform.machine(),
        "cores": os.cpu_count(),
        "mujoco": version("mujoco-core"),
        "numpy": version("numpy"),
    }


def write_json(path: Path, results: Sequence[Result], plan: Plan) -> None:
    """Write everything to a file."""
    document = {
        "machine": machine(),
        "quick": plan.quick,
        "repeats": plan.repeats,
        "clock": "processor" if plan.processor else "wall",
        "results": [result.as_json() for result in results],
    }
    path.write_text(json.dumps(document, indent=1) + "\n")
