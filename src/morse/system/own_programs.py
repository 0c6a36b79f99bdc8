"""Programs of MORSE that run as processes of their own."""

from __future__ import annotations

import sys


def command(module: str, *words: str) -> list[str]:
    """The command line that runs a module of MORSE.

    The present folder is not searched for modules: it may be a folder of downloads, with a file such as ``json.py``.
    """
    return [sys.executable, "-P", "-m", module, *words]
