"""Programs of MORSE that run as processes of their own."""

from __future__ import annotations

import io
import os
import sys


def command(module: str, *words: str) -> list[str]:
    """The command line that runs a module of MORSE.

    The present folder is not searched for modules: it may be a folder of downloads, with a file such as ``json.py``.
    """
    return [sys.executable, "-P", "-m", module, *words]


def own_output() -> io.FileIO:
    """The pipe to the process that has started this one; from now on, what others print goes to the standard error.

    Scene scripts, classes of projects and libraries print to the standard output, and would get between the messages.
    The file has no buffer.
    """
    pipe = io.FileIO(os.dup(1), "wb")
    os.dup2(2, 1)
    return pipe
