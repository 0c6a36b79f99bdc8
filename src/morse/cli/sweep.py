"""``morse sweep``: do all runs of a study."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from morse.cli.messages import CommandError, complain, existing_file, say
from morse.core.reports.printing import echo

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from morse.many import Study, Table

#: largest number of characters of an error in the list of failures
_ERROR = 200

CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="STUDY.py | rerun FOLDER RUN STUDY.py | watch FOLDER",
            help="A file with a study; or do a run again with a recording; or show how far a study is.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FOLDER", help="Folder of the results.")] = Path(
        "results"
    ),
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
    name: Annotated[
        str | None, typer.Option("--study", metavar="NAME", help="Variable of the study, if the file has several.")
    ] = None,
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="Exit with status 0 even if runs have failed.")
    ] = False,
) -> int:
    """Do all runs of a study.

    The file defines a `morse.many.Study`. Runs that the folder already contains are not done again: after an
    interruption, the same command continues. Failed runs are done again with a recording. The exit status is 3 if runs
    have failed.
    """
    if words[0] == "rerun":
        return _rerun(*_exactly(words, "rerun FOLDER RUN STUDY.py"), name=name)
    if words[0] == "watch":
        return _status(_watch(*_exactly(words, "watch FOLDER")), keep_going=keep_going)
    if len(words) != 1:
        raise CommandError(f"One file with a study, not {' '.join(words)}.", 2)
    study = _study_of(words[0], name)
    from morse.core.reports import log
    from morse.core.reports.quoting import short

    log.setup(level="WARNING")
    before = time.monotonic()
    table = _run(study, output, workers, ray)
    say(f"{len(table):,} runs in {output}, {len(table.failures):,} failed, {time.monotonic() - before:.1f} s.")
    for row in table.failures[:5]:
        again = f"; morse sweep rerun {output} {row['run']} {words[0]}" if row["recording"] else ""
        say(f"  {row['run']}: {short(row['error'], _ERROR)}{again}")
    say(f"Summary: {output / 'summary.html'}")
    return _status(len(table.failures), keep_going=keep_going)


def _status(failed: int, *, keep_going: bool) -> int:
    """The exit status for a number of failed runs."""
    from morse.simulation.ending import FAULTS

    return FAULTS if failed and not keep_going else 0


def _exactly(words: list[str], usage: str) -> list[str]:
    if len(words) != len(usage.split()):
        raise CommandError(f"The command is: morse sweep {usage}", 2)
    return words[1:]


def _study_of(file: str, name: str | None) -> Study:
    from morse.core.reports.faults import describe
    from morse.core.reports.quoting import nearest
    from morse.many import Study
    from morse.many.sources import imported

    path = existing_file(file).resolve()
    try:
        module = imported(str(path))
    except Exception as error:
        raise CommandError(f"{file} has an error: {describe(error)}") from None
    studies = {key: value for key, value in vars(module).items() if isinstance(value, Study)}
    if name is not None and name not in studies:
        raise CommandError(f"{file} has no study '{name}'{nearest(name, list(studies))}.")
    if name is None and len(studies) != 1:
        which = f"several studies, choose one by --study: {', '.join(studies)}" if studies else "no morse.many.Study"
        raise CommandError(f"{file} contains {which}.")
    return studies[name] if name is not None else next(iter(studies.values()))


def _run(study: Study, folder: Path, workers: int | None, ray: str | None) -> Table:
    from morse.many.rays import RayExecutor

    executor: Executor | None = None
    try:
        if ray is not None:
            executor = RayExecutor(ray, workers)
        return study.run(folder, workers=workers, executor=executor, progress=ProgressLine())
    except KeyboardInterrupt:
        complain("Stopped. The same command continues.")
        raise typer.Exit(130) from None
    except (ImportError, ConnectionError, RuntimeError, OSError, TypeError, ValueError) as error:
        raise CommandError(str(error)) from None
    finally:
        _end_line()
        if executor is not None:
            executor.shutdown()


class ProgressLine:
    """Prints the progress on one line of a terminal; elsewhere a line whenever it has changed."""

    _last = ""

    def __call__(self, text: str) -> None:
        """Show how far the study is."""
        if sys.stderr.isatty():
            echo(text, err=True, end="", over=True)
        elif text != self._last:
            echo(text, err=True)
        self._last = text


def _end_line() -> None:
    if sys.stderr.isatty():
        echo(err=True)


def _rerun(folder: str, run: str, file: str, *, name: str | None) -> int:
    # results are data: which program is executed says the user, not the folder
    try:
        row = _study_of(file, name).rerun(folder, run)
    except (LookupError, ImportError, AttributeError, OSError, ValueError) as error:
        raise CommandError(str(error)) from None
    say(f"{row['run']}: {row['error'] or 'no error'}; {row['ticks']} ticks, {row['wall']:.2f} s")
    if not row["same_identity"]:
        say("The code, the arguments, the options, the timeout or the versions have changed since then.")
    say("The state at the end is the same, bit for bit." if row["same"] else "The state at the end is another one.")
    say(f"Recording: {os.path.join(folder, row['recording'])}")
    return 0 if row["same"] else 1


def _watch(folder: str) -> int:
    """Show the progress until all runs are done, or Ctrl+C; return the number of failed runs."""
    from morse.many import Table
    from morse.many.progress import Progress
    from morse.many.results import read_facts

    progress: Progress | None = None
    tell = ProgressLine()
    try:
        while True:
            try:
                table = Table.read(folder)
                total = read_facts(folder)["runs"]
            except (OSError, ValueError) as error:
                raise CommandError(str(error)) from None
            if progress is None:
                progress = Progress(total, len(table), len(table.failures))
            progress.done, progress.failed = len(table), len(table.failures)
            tell(str(progress))
            if len(table) >= total:
                return progress.failed
            time.sleep(1.0)
    except KeyboardInterrupt:
        return 0  # the study goes on
    finally:
        _end_line()
