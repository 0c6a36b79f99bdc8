"""Reads the log of a simulation while it is being written."""

from __future__ import annotations

import re
import threading
import time
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path
    from typing import TextIO

INITIALIZED = "SCENE INITIALIZED"
EXITING = "EXITING SIMULATION"
#: words of lines about errors that have lines of their own
_ABOUT_OTHERS = (
    "switched off by faults in this run:",
    "robots that have left the world",
    "before the failure are in ",
    "of the failure is in ",
)
#: a robot in the last lines of a run
_LEFT = re.compile(r"  at \d+\.\d+ s .* has left the world: ")
#: largest number of errors that are kept
_MOST = 1000
#: matches only at the beginning of a record, because texts of clients and scripts are farther to the right
_ERROR = re.compile(r"(\x1b\[[\d;]+m)?(\[[\w.]+\] )?(\[ERROR\]\[MORSE\]|INITIALIZATION ERROR)")
_PORT = re.compile(r"services are on port (\d+)")
_PERIOD = 0.02
_TAIL = 40


def _never() -> bool:
    return False


def follow(file: TextIO, has_ended: Callable[[], bool] = _never) -> Iterator[str]:
    """The lines of a file, while they are written.

    Args:
        has_ended: function that returns whether nothing more will be written; without it, the lines never end.
    """
    partial = ""
    while True:
        last = has_ended()
        if chunk := file.readline():
            partial += chunk
            if partial.endswith("\n"):
                yield partial
                partial = ""
        elif last:
            if partial:
                yield partial
            return
        else:
            time.sleep(_PERIOD)


def names_one(line: str, parts: Iterable[str]) -> bool:
    """Whether a line names one of some parts of a simulation, such as ``robot.gps``."""
    return any(re.search(rf"(?<![\w.]){re.escape(part)}(?!\w|\.\w)", line) for part in parts)


def unexpected(errors: Sequence[str], fails: Iterable[str]) -> list[str]:
    """Return what is wrong with the errors of a simulation, one line each.

    Args:
        errors: lines that name parts of the simulation.
        fails: names of the parts that are expected to fail.
    """
    parts = list(fails)
    wrong = [f"the simulation reported an error: {line}" for line in errors if not names_one(line, parts)]
    missing = [part for part in parts if not any(names_one(line, [part]) for line in errors)]
    return wrong + [f"'{part}' was expected to fail, and has not failed" for part in missing]


class LogWatch(threading.Thread):
    """Follows and evaluates the log of a simulation.

    Args:
        path: path of the log.
        ended: function that returns whether the process has ended.
        on_error: callback, called with the first line that reports an unexpected error after the start.
        fails: names of the parts that are expected to fail.

    Attributes:
        pid: process id of the simulation, once it was logged.
        port: port of its services, once it was logged.
        error: the first line that reports an unexpected error.
        errors: all lines that report an error, and those of robots that have left the world.
        initialized: whether it has begun to run.
        tail: the last lines.
    """

    def __init__(
        self, path: Path, has_ended: Callable[[], bool], on_error: Callable[[str], None], fails: Sequence[str] = ()
    ) -> None:
        super().__init__(name=f"log of {path.name}", daemon=True)
        self._path = path
        self._ended = has_ended
        self._on_error = on_error
        self._fails = fails
        self._change = threading.Condition()
        self.pid: int | None = None
        self.port: int | None = None
        self.error: str | None = None
        self.errors: list[str] = []
        self.initialized = False
        self.over = False
        self.tail: deque[str] = deque(maxlen=_TAIL)

    def run(self) -> None:
        """Read until the process has ended and all of its output has been read."""
        with self._path.open(encoding="utf-8", errors="replace") as log:
            for line in follow(log, self._ended):
                self._read(line.rstrip("\n"))
        with self._change:
            self.over = True
            self._change.notify_all()

    def _read(self, line: str) -> None:
        with self._change:
            self.tail.append(line)
            if self.pid is None and "PID" in line:
                last = line.split()[-1]
                self.pid = int(last) if last.isdecimal() else None
            if self.port is None and (match := _PORT.search(line)):
                self.port = int(match[1])
            if INITIALIZED in line:
                self.initialized = True
            reports = _ERROR.match(line) is not None and not any(words in line for words in _ABOUT_OTHERS)
            if (reports or _LEFT.match(line)) and len(self.errors) < _MOST:
                self.errors.append(line.strip())
            is_error = reports and self.error is None and not names_one(line, self._fails)
            if is_error:
                self.error = line
            is_running = self.initialized
            self._change.notify_all()
        if is_error and is_running:
            self._on_error(line)

    def wait(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Wait until ``condition()`` is true, or until the log has ended; return its last value."""
        deadline = time.monotonic() + timeout
        with self._change:
            while not condition() and not self.over:
                remaining = deadline - time.monotonic()
                if remaining <= 0:
                    break
                self._change.wait(min(remaining, 0.5))
            return condition()

    def excerpt(self) -> str:
        """The last lines of the log, indented."""
        return "\n".join(f"    {line}" for line in self.tail) or "    (the log is empty)"
