"""The ``morse`` command."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from collections.abc import Sequence


def main() -> NoReturn:
    """Entry point of ``morse``: run the command line of this process and exit with its status."""
    run_and_exit(sys.argv[1:])


def run_and_exit(arguments: Sequence[str]) -> NoReturn:
    """Run a command line (the words after ``morse``) and end the process."""
    try:
        from morse.cli.app import execute

        status = execute(arguments)
    except KeyboardInterrupt:
        # Ctrl+C ends the command at any moment, even while it is being loaded
        status = 130
    sys.exit(status)
