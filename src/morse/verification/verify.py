"""Checks that a scene is repeatable bit for bit, independent of observers and speed."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import threading
from typing import TYPE_CHECKING, Any

from morse.system.workers import command
from morse.verification.replay import Replay

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.simulation.options import RunOptions

#: the fingerprint of every part after a tick
_Record = dict[str, str]


class ReplayError(Exception):
    """A run did not end regularly; the text is its output."""


@dataclasses.dataclass(frozen=True, slots=True)
class Difference:
    """The first tick and the first part of it that differ between two runs.

    Attributes:
        runs: which two.
        tick: counted from 1.
        part: name of a robot or component, or ``physics``.
    """

    runs: str
    tick: int
    part: str


def verify(
    options: RunOptions,
    ticks: int | None,
    progress: Callable[[str], object] = print,
    *,
    clients: int = 2,
    pages: int = 1,
    failed: Callable[[str], object] = print,
) -> list[Difference]:
    """Run a scene several times and compare every tick, to the bit.

    A first process runs it as fast as possible, then restarts it. A second process runs it with the
    live view and pages, with clients that read every stream, in step with the wall clock, and
    with another seed of string hashes.

    Args:
        ticks: length of the runs; None for the duration of the options.
        progress: called with descriptions of the runs.
        clients: on every stream.
        pages: of the live view.
        failed: called with one line for each part that a fault has switched off in the first process, if there are any.

    Returns:
        The differences, at most one for each comparison; none if all runs are equal.

    Raises:
        ReplayError: a run failed.
    """
    progress("a first run, and one more after a restart in the same process")
    first, failures = _replay(dataclasses.replace(options, view="none"), "1", ticks=ticks, restarts=1)
    progress("another process, with the live view open, clients that read, and the pace of the wall clock")
    watched = dataclasses.replace(options, view="web")
    second, _ = _replay(watched, "2", ticks=ticks, clients=clients, pages=pages, paced=True)
    if failures:
        failed(failures)
    comparisons = [
        ("a new process and a restart", first[: len(second)], first[len(second) :]),
        ("two processes, one of them watched and paced", first[: len(second)], second),
    ]
    return [d for name, a, b in comparisons for d in _first_difference(name, a, b)]


def _replay(options: RunOptions, hashes: str, **options_of_replay: Any) -> tuple[list[_Record], str]:
    """The fingerprints of each tick, and the parts that have failed."""
    plain = dataclasses.replace(options, view_port=0, open_browser=False, profile=False, keep_going=True)
    replay = Replay(options=dataclasses.asdict(plain), **options_of_replay)
    # another hash seed reveals programs that depend on the order of sets
    environment = {**os.environ, "PYTHONHASHSEED": hashes, "MORSE_SOCKET_PORT": "0"}
    words = command("morse.verification.replay", json.dumps(dataclasses.asdict(replay)))
    pipe = subprocess.PIPE
    # its standard input stays open until this process ends, even if it is killed
    with subprocess.Popen(
        words, stdin=pipe, stdout=pipe, stderr=pipe, encoding="utf-8", errors="replace", env=environment
    ) as process:
        try:
            records, errors = _read(process)
        except BaseException:
            process.kill()
            raise
    if process.returncode:
        raise ReplayError(errors.strip())
    *ticks, failures = map(json.loads, records.splitlines())
    return ticks, failures


def _read(process: subprocess.Popen[str]) -> tuple[str, str]:
    """All output of a process, without closing its standard input, unlike `Popen.communicate`."""
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    lines: list[str] = []
    listener = threading.Thread(target=lambda stream: lines.append(stream.read()), args=(process.stderr,))
    listener.start()
    records = process.stdout.read()
    listener.join()
    process.wait()
    return records, lines[0]


def _first_difference(runs: str, a: list[_Record], b: list[_Record]) -> Iterator[Difference]:
    for tick, (one, other) in enumerate(zip(a, b, strict=True), 1):
        for part in one:
            if one[part] != other.get(part):
                yield Difference(runs, tick, part)
                return
