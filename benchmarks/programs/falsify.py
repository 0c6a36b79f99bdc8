"""Twenty planted faults: how many does the guided search find, and how many a search at random, with the same runs?

``python -m benchmarks.programs.falsify --runs 1000`` prints a line of JSON, ``--table`` a table for the documentation.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.programs.planted import FAULTS, scene
from morse.many import Scenario


def drive(sim: Any, fault: str, **parameters: float) -> dict[str, float]:
    """Do a run of a fault."""
    return {"margin": FAULTS[fault].run(sim, **parameters)}


def scenario_of(name: str) -> Any:
    """The scenario of a fault; its defaults are those of the controller."""
    fault = FAULTS[name]
    arguments = fault.run.__defaults__ or ()
    names = fault.run.__code__.co_varnames[1 : 1 + len(arguments)]
    defaults = {key: value for key, value in zip(names, arguments, strict=True) if key in fault.parameters}
    scenario = Scenario(scene, partial(drive, fault=name), defaults=defaults, mended=False, **fault.parameters)
    scenario.always(f"margin > {fault.limit}")
    return scenario


def search(name: str, how: str, runs: int, workers: int) -> dict[str, Any]:
    """Search for a fault; returns what was found."""
    scenario = scenario_of(name)
    with tempfile.TemporaryDirectory() as folder:
        found = scenario.falsify(folder, budget=3600.0, runs=runs, workers=workers, search=how)
        rows = found.rows
        margins = [row.get("margin", -math.inf) for row in rows]
        first = next((number for number, margin in enumerate(margins, 1) if margin <= FAULTS[name].limit), None)
        result: dict[str, Any] = {"found": first is not None, "runs": first or len(rows)}
        result["cpu"] = sum(row["cpu"] for row in rows[: result["runs"]])
        if not found.failures:
            return result
        smallest = found.smallest.parameters
        changed = [key for key in FAULTS[name].parameters if smallest[key] != scenario.space.defaults[key]]
        result |= {"smallest": {key: smallest[key] for key in changed}, "all_runs": len(rows)}
        result["mended"] = (
            scenario.once(**{**_without(smallest, "seed"), "mended": True})["margin"] > FAULTS[name].limit
        )
        result["off"] = _off(name, scenario, smallest)
        return result


def _without(parameters: dict[str, Any], name: str) -> dict[str, Any]:
    return {key: value for key, value in parameters.items() if key != name}


def _off(name: str, scenario: Any, smallest: dict[str, Any]) -> float:
    """The greatest distance of a parameter from its known boundary, as a share of its range."""
    axes = {axis.name: axis for axis in scenario.space.free}
    worst = 0.0
    for key, value in FAULTS[name].known.items():
        low, high = axes[key].limits
        # what begins at an angle begins on both sides
        sides = [side for side in (value, -value) if low <= side <= high]
        worst = max(worst, min(axes[key].distance(smallest[key], side) for side in sides))
    return worst


def main() -> None:
    """Search for all faults."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--search", nargs="*", default=["auto", "random"])
    parser.add_argument("--faults", nargs="*", default=list(FAULTS))
    parser.add_argument("--table", type=Path)
    options = parser.parse_args()
    results: dict[str, dict[str, Any]] = {}
    for name in options.faults:
        results[name] = {}
        for how in options.search:
            begin = time.perf_counter()
            results[name][how] = search(name, how, options.runs, options.workers)
            results[name][how]["wall"] = round(time.perf_counter() - begin, 1)
            print(json.dumps({"fault": name, "search": how, **results[name][how]}), flush=True)
    counts = {how: sum(result[how]["found"] for result in results.values()) for how in options.search}
    print(json.dumps({"faults": len(results), "runs": options.runs, **counts}))
    if options.table:
        options.table.write_text(table(results), encoding="utf-8")


def table(results: dict[str, dict[str, Any]]) -> str:
    """The results as a table in Markdown."""
    searches = list(next(iter(results.values())))
    lines = [f"| fault | {' | '.join(searches)} | smallest case |", f"|---|{'--:|' * len(searches)}---|"]
    for name, result in results.items():
        cells = [f"{result[how]['runs']:,}" if result[how]["found"] else "–" for how in searches]
        smallest = next((one["smallest"] for one in result.values() if "smallest" in one), {})
        given = ", ".join(f"{key} {value:.3g}" for key, value in smallest.items())
        lines.append(f"| {FAULTS[name].what} | {' | '.join(cells)} | {given} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
