"""Runs the check of a lesson in a process of its own: the program of a student may do anything.

The process writes the findings into a file. It has the rights of the user: check programs that you do not trust in a
container.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import CHECK_ENDS, CHECK_RUNS, LONGEST_CHECK, PROGRAM_RUNS, Attempt, Finding
from morse.plugins.lessons.catalog import Lesson, lesson
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Sequence

#: wall-clock seconds of a whole check, for programs that wait; those that compute have less, `LONGEST_CHECK`
_LONGEST = 1800.0
#: memory that a check may take, bytes: one that takes all would end other programs, too
_MOST_MEMORY = 4 * 2**30
#: largest file of findings, bytes
_LARGEST = 2**20


@dataclass(frozen=True, slots=True)
class Result:
    """The result of a check.

    Attributes:
        findings: the points of the check; at least one.
    """

    findings: tuple[Finding, ...]

    @property
    def is_passed(self) -> bool:
        """Whether all is right."""
        return all(finding.is_right for finding in self.findings)

    @property
    def is_complete(self) -> bool:
        """Whether the check came to its end, so that the points are all that there are."""
        cut_short = (PROGRAM_RUNS, CHECK_RUNS, CHECK_ENDS)
        return not any(finding.what in cut_short and not finding.is_right for finding in self.findings)


def examine(what: Lesson, folder: Path, *, is_quiet: bool = False, seconds: float = _LONGEST) -> Result:
    """Check the program of a student.

    Args:
        what: the lesson.
        folder: the folder with the program.
        is_quiet: whether what the program prints is not shown.
        seconds: the longest wall-clock time of the check.
    """
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "findings.json"
        # without the working directory on the import path, in which a student may have a json.py
        command = [sys.executable, "-P", "-m", "morse.plugins.lessons.examining", what.name, str(folder), str(file)]
        output = subprocess.DEVNULL if is_quiet else None
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True
        )
        try:
            status = process.wait(seconds)
        except subprocess.TimeoutExpired:
            return Result((Finding(CHECK_ENDS, False, f"it has not ended after {seconds:g} s"),))
        finally:
            _end(process)
        findings = _read(file)
        if not findings:
            findings = (Finding(CHECK_ENDS, False, f"its process ended with status {status}"),)
        return Result(findings)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process and, on POSIX systems, those that it has started."""
    if sys.platform == "win32":
        process.kill()
    else:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _read(file: Path) -> tuple[Finding, ...]:
    try:
        rows = json.loads(read_regular(file, _LARGEST))
        return tuple(Finding(str(row["what"]), row["is_right"] is True, str(row["hint"])) for row in rows)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()


def _limit() -> None:
    """Limit the memory of this process, and end it some time after `LONGEST_CHECK`, also within one long operation."""
    if sys.platform != "win32":
        import resource

        _soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
        most = _MOST_MEMORY if hard < 0 else min(_MOST_MEMORY, hard)
        with contextlib.suppress(OSError, ValueError):  # macOS may refuse it
            resource.setrlimit(resource.RLIMIT_DATA, (most, hard))
        longest = int(LONGEST_CHECK) + 30
        _soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (longest if hard < 0 else min(longest, hard), hard))


def main(words: Sequence[str]) -> int:
    """Check a program: the name of the lesson, the folder of the student, the file of the findings."""
    name, folder, file = words
    logging.disable(logging.WARNING)  # a student reads findings, not the log of the simulation
    attempt = Attempt(lesson(name), Path(folder).absolute())

    def write() -> None:
        Path(file).write_text(json.dumps([finding.as_data() for finding in attempt.findings]), encoding="utf-8")

    try:
        attempt.run(write)
    except KeyboardInterrupt:
        return 130
    with contextlib.suppress(OSError):
        write()
    return 0


if __name__ == "__main__":
    _limit()
    _status = main(sys.argv[1:])
    with contextlib.suppress(Exception):  # a program may replace them
        sys.stdout.flush()
        sys.stderr.flush()
    # threads of the program may go on without end
    os._exit(_status)
