"""What came out, as a table and as JSON."""

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

_MARKS = {True: "[green]ok[/]", False: "[yellow]short[/]", None: ""}


def table(results: Sequence[Result]) -> Table:
    """A line for each result."""
    made = Table(title="Benchmarks")
    for column in ("benchmark", "case"):
        made.add_column(column)
    for column in ("wanted", "reached", ""):
        made.add_column(column, justify="right")
    made.add_column("others")
    for result in results:
        wanted = "" if result.wanted is None else f"{result.wanted.relation} {result.wanted.bound:g}"
        mark = "[red]FAILED[/]" if result.failed else _MARKS[result.is_good]
        others = ", ".join(f"{name} {_number(value)}" for name, value in result.peers.items())
        if "morse" in result.details:
            others = f"morse {_number(result.details['morse'])}, {others}"
        made.add_row(result.benchmark, result.case, wanted, _reached(result), mark, result.trouble or others)
    return made


def _reached(result: Result) -> str:
    return "" if result.value is None else f"{_number(result.value)} {result.unit}"


def _number(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def busy() -> str:
    """A warning if the machine does other work."""
    if not hasattr(os, "getloadavg"):
        return ""
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    if load < 0.5 * cores:
        return ""
    return f"This machine is busy (load {load:.1f} on {cores} cores): expect figures to scatter, or use --processor."


def machine() -> dict[str, Any]:
    """What was measured on, and what."""
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
