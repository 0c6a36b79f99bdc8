"""The ``morse`` command."""

from __future__ import annotations

import contextlib
import os
import sys
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from collections.abc import Sequence


def main() -> NoReturn:
    """Entry point of ``morse``: run the command line of this process and exit with its status."""
    run_and_exit(sys.argv[1:])


def run_and_exit(arguments: Sequence[str]) -> NoReturn:
    """Run a command line (the words after ``morse``) and end the process."""
    _open_closed_streams()
    try:
        from morse.cli.app import execute

        status = execute(arguments)
    except KeyboardInterrupt:
        # Ctrl+C ends the command at any time, even while it is being loaded
        status = 130
    sys.exit(_written(status))


def _written(status: int) -> int:
    """Write the rest of the output, and return the status.

    Otherwise Python does so at its end, and fails with status 120 where the disk is full or nobody reads any more.
    """
    if sys.stdout is None:  # a component has removed it
        return status
    try:
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        from morse.core.reports import log

        with contextlib.suppress(OSError, ValueError):
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, sys.stdout.fileno())
            os.close(null)
        if not isinstance(error, BrokenPipeError) and not log.is_lost():
            log.complain(f"the output could not be written: {getattr(error, 'strerror', None) or error}")
            return status or 1
    return status


def _open_closed_streams() -> None:
    """Replace closed standard streams (``morse run scene.py >&-``) by the null device.

    Otherwise a file or socket that is opened later would get the descriptor of the standard output.
    """
    is_closed = sys.stdout is None
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            # open returns the lowest free descriptor, which is this one
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            mode = "r" if name == "stdin" else "w"
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (open as long as the process)
    if is_closed:
        from morse.cli.messages import complain

        complain("The standard output is closed: the log of the simulation is lost.")
