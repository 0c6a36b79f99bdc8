"""The ``morse`` command."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of ``morse``: run the command line of this process and exit with its status."""
    from morse.cli.app import execute

    sys.exit(execute(sys.argv[1:]))
