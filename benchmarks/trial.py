"""Runs programs, in turn, and takes medians."""

from __future__ import annotations

import json
import math
import os
import statistics
import subprocess
import sys
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ROOT = Path(__file__).parents[1]
_TIMEOUT = 600.0

Record = dict[str, Any]


class TrialFailed(Exception):
    """A program broke down, or its work was wrong."""


def environment() -> dict[str, str]:
    """For programs: they find these packages, and take whatever port is free."""
    paths = [str(ROOT), str(ROOT / "src"), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths)), "MORSE_SOCKET_PORT": "0"}


@dataclass(frozen=True)
class Program:
    """A program that does the work and reports a line of JSON.

    Attributes:
        name: of the simulator.
        module: to be run with ``python -m``.
        arguments: of the program.
        needs: package that has to be installed; None for nothing.
        is_optional: if it breaks down or works wrongly, it is left out.
    """

    name: str
    module: str
    arguments: tuple[str, ...] = ()
    needs: str | None = None
    is_optional: bool = False

    @property
    def is_installed(self) -> bool:
        """Whether it can be run here."""
        return self.needs is None or find_spec(self.needs) is not None

    def run(self) -> Record:
        """Run it and return what it reports.

        Raises:
            TrialFailed: it broke down.
        """
        command = [sys.executable, "-m", self.module, *self.arguments]
        try:
            done = subprocess.run(
                command, env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=_TIMEOUT, check=False
            )
        except subprocess.TimeoutExpired:
            raise TrialFailed(f"{self.name} {' '.join(self.arguments)} took more than {_TIMEOUT:.0f} s") from None
        lines = done.stdout.strip().splitlines()
        if done.returncode != 0 or not lines:
            said = "\n".join((done.stderr or done.stdout).strip().splitlines()[-5:])
            raise TrialFailed(f"{self.name} {' '.join(self.arguments)} broke down:\n{said}")
        result: Record = json.loads(lines[-1])
        return result


@dataclass
class Trial:
    """What the runs of one program came to.

    Attributes:
        program: that was run.
        records: one a run.
        trouble: why an optional program is left out.
    """

    program: Program
    records: list[Record] = field(default_factory=list)
    trouble: str = ""

    def median(self, key: str) -> float:
        """Of a value over all runs."""
        return statistics.median(record[key] for record in self.records)


def interleave(
    programs: Iterable[Program], repeats: int, check: Callable[[Record], str | None] = lambda _: None
) -> dict[str, Trial]:
    """Run programs in turn, so that whatever else the machine does falls on all of them.

    Args:
        check: says what is wrong with the work of a run, or None.

    Returns:
        Trials by the names of the programs.

    Raises:
        TrialFailed: a program that is not optional broke down or did the work wrongly.
    """
    trials = {program.name: Trial(program) for program in programs}
    for _ in range(repeats):
        for trial in trials.values():
            if trial.trouble:
                continue
            try:
                trial.records.append(_run(trial.program, check))
            except TrialFailed as error:
                if not trial.program.is_optional:
                    raise
                trial.trouble = str(error)
    return trials


def _run(program: Program, check: Callable[[Record], str | None]) -> Record:
    record = program.run()
    wrong = check(record)
    if wrong is not None:
        raise TrialFailed(f"{program.name} {' '.join(program.arguments)}: the work is wrong:\n{wrong}")
    return record


def beyond(record: Record, key: str, most: float) -> str | None:
    """What to say if a value is missing, no number, or more than allowed."""
    value = record.get(key, math.nan)
    return None if value <= most else f"{key} is {value:.3g}, more than {most:g}"
