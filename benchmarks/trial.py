"""Runs programs in turn, and computes medians."""

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
    """A program failed, or gave wrong results."""


def environment() -> dict[str, str]:
    """The environment of programs: they import these packages, and use any free port."""
    paths = [str(ROOT), str(ROOT / "src"), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths)), "MORSE_SOCKET_PORT": "0"}


@dataclass(frozen=True)
class Program:
    """A program that does the work and reports a line of JSON.

    Attributes:
        name: name of the simulator.
        module: run with ``python -m``.
        arguments: arguments of the program.
        needs: required package, or None.
        is_optional: if it fails or gives wrong results, it is left out.
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
        """Run it and return its report.

        Raises:
            TrialFailed: it failed.
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
            raise TrialFailed(f"{self.name} {' '.join(self.arguments)} failed:\n{said}")
        result: Record = json.loads(lines[-1])
        return result


@dataclass
class Trial:
    """The results of the runs of one program.

    Attributes:
        program: the program.
        records: one per run.
        trouble: the reason why an optional program is left out.
    """

    program: Program
    records: list[Record] = field(default_factory=list)
    trouble: str = ""

    def median(self, key: str) -> float:
        """The median of a value over all runs."""
        return statistics.median(record[key] for record in self.records)


def interleave(
    programs: Iterable[Program], repeats: int, check: Callable[[Record], str | None] = lambda _: None
) -> dict[str, Trial]:
    """Run programs in turn, so that changes of the load affect all of them.

    Args:
        check: returns the error of a run, or None.

    Returns:
        Trials by the names of the programs.

    Raises:
        TrialFailed: a program that is not optional failed or gave wrong results.
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
    """A message if a value is missing, not a number, or larger than allowed; else None."""
    value = record.get(key, math.nan)
    return None if value <= most else f"{key} is {value:.3g}, more than {most:g}"
