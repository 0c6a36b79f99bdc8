"""``python -m benchmarks``: measure, compare, report."""

from __future__ import annotations

from pathlib import Path  # noqa: TC003 (typer reads the annotations)
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from benchmarks import report
from benchmarks.plan import Plan
from benchmarks.plot import draw, speed_lines
from benchmarks.suites.circles import PEERS, circles, growth, readers
from benchmarks.suites.components import components
from benchmarks.suites.crowd import crowd, people, view
from benchmarks.suites.floods import floods
from benchmarks.suites.launch import launch
from benchmarks.suites.lockstep import lockstep
from benchmarks.suites.many import many
from benchmarks.suites.page import page
from benchmarks.suites.panorama import panorama
from benchmarks.suites.pictures import pictures
from benchmarks.suites.pushing import pushing
from benchmarks.trial import Program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from benchmarks.result import Result

SUITES: dict[str, Callable[[Plan], Iterator[Result]]] = {
    "circles": circles,
    "pushing": pushing,
    "panorama": panorama,
    "pictures": pictures,
    "many": many,
    "launch": launch,
    "lockstep": lockstep,
    "components": components,
    "readers": readers,
    "view": view,
    "page": page,
    "crowd": crowd,
    "people": people,
    "growth": growth,
    "floods": floods,
}


def main(
    names: Annotated[list[str] | None, typer.Argument(help=f"Which of: {', '.join(SUITES)}. All by default.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Only check that everything runs correctly.")] = False,
    repeats: Annotated[int, typer.Option(min=1, help="Runs of each program; medians are reported.")] = 3,
    processor: Annotated[bool, typer.Option("--processor", help="Measure processor time.")] = False,
    json: Annotated[Path | None, typer.Option("--json", help="Write all figures to this file.")] = None,
    markdown: Annotated[Path | None, typer.Option("--markdown", help="Write the table to this file, too.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw speed by number of robots: an SVG file.")] = None,
) -> None:
    """Measure MORSE beside bare MuJoCo loops and the simulators that are installed.

    The exit status is 1 if a program failed or gave wrong results; a value that misses its target is not a failure.
    """
    console = Console()
    unknown = sorted(set(names or ()) - SUITES.keys())
    if unknown:
        raise typer.BadParameter(f"no benchmark '{unknown[0]}'; there are {', '.join(SUITES)}")
    plan = Plan(quick=quick, repeats=1 if quick else repeats, processor=processor)
    missing = [peer for peer in PEERS if not Program(peer, "", needs=peer).is_installed]
    if missing:
        console.print(f"Not installed, so not compared with: {', '.join(missing)}.", style="dim")
    if warning := report.busy():
        console.print(warning, style="yellow")
    results = []
    for name in names or SUITES:
        with console.status(f"{name} ..."):
            results += list(SUITES[name](plan))
    console.print(report.table(results))
    if json is not None:
        report.write_json(json, results, plan)
    if markdown is not None:
        markdown.write_text(report.markdown(results, plan))
    if plot is not None and (lines := speed_lines(results)):
        plot.write_text(draw(lines))
    if any(result.failed for result in results):
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
