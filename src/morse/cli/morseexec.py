"""``morseexec SCRIPT``: the same as ``morse run SCRIPT``.

It is meant for the first line of a scene script, where only one word may follow the interpreter::

    #! /usr/bin/env morseexec
"""

from __future__ import annotations

import sys
from typing import NoReturn

from morse.cli import run_and_exit
from morse.cli.messages import complain


def main() -> NoReturn:
    """Entry point of ``morseexec``."""
    if len(sys.argv) < 2:
        complain("Usage: morseexec SCRIPT [ARGUMENTS of the script]")
        sys.exit(2)
    run_and_exit(["run", *sys.argv[1:]])
