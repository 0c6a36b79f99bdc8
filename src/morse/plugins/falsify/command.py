"""``morse falsify``: search for the smallest parameters with which a requirement is violated."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from morse.core.exceptions import MorseError
from morse.core.reports.faults import describe
from morse.core.reports.log import setup
from morse.core.reports.printing import echo, harmless_paragraph

_SEARCHES = "How to search: auto, random, halton, guided, cma, optuna."
#: exit status if something has failed, as of a run with faults
_FAILED = 3


class FalsifyError(MorseError):
    """The command cannot do what it was asked."""


def command(
    file: Annotated[str, typer.Argument(metavar="SCENARIO.py", help="A file with a Scenario.", show_default=False)],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Folder of the results.")] = Path(
        "results"
    ),
    budget: Annotated[float, typer.Option("--budget", min=0.1, help="Wall-clock time for the search, s.")] = 600.0,
    runs: Annotated[
        int | None, typer.Option("--runs", min=1, help="Largest number of runs.", show_default=False)
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=0, help="Number of processes; 0 for this process.", show_default=False),
    ] = None,
    ray: Annotated[
        str | None,
        typer.Option(
            "--ray", metavar="ADDRESS", help="Do the runs on a cluster of Ray: auto, local, ray://host:10001."
        ),
    ] = None,
    search: Annotated[str, typer.Option("--search", metavar="NAME", help=_SEARCHES)] = "auto",
    name: Annotated[
        str | None,
        typer.Option("--scenario", metavar="NAME", help="Variable of the scenario, if the file has several."),
    ] = None,
    whole_budget: Annotated[
        bool,
        typer.Option("--whole-budget", help="Continue to search for other failures after each requirement has failed."),
    ] = False,
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="Exit with status 0 even if something has failed.")
    ] = False,
) -> int:
    """Search for the smallest parameters with which a requirement is violated.

    The file defines a `morse.many.Scenario`. The folder then contains a page with all that was found, recordings, tests
    that fail until the software is mended, and JUnit. The same command continues a search that was interrupted. The
    exit status is 3 if something has failed.
    """
    # imported on demand, so that 'morse -h' does not load the simulator
    from morse.plugins.falsify.report import PAGE, summary
    from morse.plugins.falsify.scenario import read_scenario

    scenario = read_scenario(file, name)
    setup(level="WARNING")
    executor: Any = None
    try:
        if ray is not None:
            from morse.many.rays import RayExecutor

            executor = RayExecutor(ray, workers)
        found = scenario.falsify(
            output,
            budget=budget,
            runs=runs,
            workers=workers,
            executor=executor,
            search=search,
            whole_budget=whole_budget,
            progress=_progress,
        )
    except OSError as error:
        what = f"{error.filename or output}: {error.strerror or error}"
        if not output.is_dir():
            raise FalsifyError(f"the results cannot be written: {what}; give another folder by -o") from None
        raise FalsifyError(f"{what}: what was done is kept, and the same command continues") from None
    except (ImportError, RuntimeError, TypeError, ValueError) as error:
        raise FalsifyError(describe(error)) from None
    finally:
        if executor is not None:
            executor.shutdown()
    if sys.stderr.isatty():
        echo(err=True)
    for line in summary(found):
        echo(f"* {harmless_paragraph(line)}")
    echo(f"* {output / PAGE} shows all of it.")
    return _FAILED if found.failures and not keep_going else 0


def _progress(text: str) -> None:
    if sys.stderr.isatty():
        echo(text, err=True, end="", over=True)
    else:
        echo(text, err=True)
