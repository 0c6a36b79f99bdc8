"""``morseexec SCRIPT``: the same as ``morse run SCRIPT``.

Made for the first line of a scene script, where only one word may follow the interpreter::

    #! /usr/bin/env morseexec
"""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of ``morseexec``."""
    from morse.cli.app import execute

    if len(sys.argv) < 2:
        print("* Usage: morseexec SCRIPT [ARGUMENTS of the script]", file=sys.stderr)
        sys.exit(2)
    sys.exit(execute(["run", *sys.argv[1:]]))
