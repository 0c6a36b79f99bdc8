"""Checks that a scene gives the same bits again: in another process, with a view, after a restart."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.simulation.options import RunOptions

#: tick, and the fingerprint of every part after it
_Record = dict[str, str]


class ReplayError(Exception):
    """A run did not come to its end; the text is what it printed."""


@dataclasses.dataclass(frozen=True, slots=True)
class Difference:
    """The first tick and the first part of it that differ between two runs."""

    runs: str
    tick: int
    part: str


def verify(options: RunOptions, ticks: int, progress: Callable[[str], None]) -> list[Difference]:
    """Run a scene several times and compare every tick, to the bit.

    Args:
        progress: told what is being run.

    Returns:
        The differences, one at most for each comparison; none if all runs are equal.

    Raises:
        ReplayError: a run failed.
    """
    with tempfile.TemporaryDirectory(prefix="morse-verify-") as folder:
        progress("a first run, and one more after a restart in the same process")
        first = _replay(options, "none", ticks, 1, Path(folder) / "first")
        progress("another process, with the live view open")
        second = _replay(options, "web", ticks, 0, Path(folder) / "second")
    comparisons = [
        ("a new process and a restart", first[:ticks], first[ticks:]),
        ("two processes, one of them with the live view", first[:ticks], second),
    ]
    return [d for name, a, b in comparisons for d in _first_difference(name, a, b)]


def _replay(options: RunOptions, view: str, ticks: int, restarts: int, output: Path) -> list[_Record]:
    plain = dataclasses.asdict(dataclasses.replace(options, view=view, view_port=0, open_browser=False, speed=None))
    wanted = {"options": plain, "ticks": ticks, "restarts": restarts, "output": str(output)}
    command = [sys.executable, "-m", "morse.verification.replay", json.dumps(wanted)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ReplayError((done.stdout + done.stderr).strip())
    return [json.loads(line)["parts"] for line in output.read_text().splitlines()]


def _first_difference(runs: str, a: list[_Record], b: list[_Record]) -> Iterator[Difference]:
    for tick, (one, other) in enumerate(zip(a, b, strict=True), 1):
        for part in one:
            if one[part] != other.get(part):
                yield Difference(runs, tick, part)
                return
