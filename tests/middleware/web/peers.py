"""Peer programs, each in a separate process."""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.kit import programs

_HERE = Path(__file__).parent
#: by the suffix of a program; all others are run by this Python
_RUNS = {".mjs": "node"}


def need(module: str) -> None:
    """Skip the test if the module is missing; in CI, the test fails."""
    try:
        __import__(module)
    except ImportError:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"there is no module {module}")


def talk(program: str | Path, step: Callable[[], object], *arguments: object) -> Any:
    """Step until a program has ended; returns its output, which is JSON unless it is a text.

    Args:
        program: a file beside this one, or a path.
        step: runs a tick.
        arguments: arguments of the program.
    """
    path = program if isinstance(program, Path) else _HERE / program
    text = programs.talk([_RUNS.get(path.suffix, sys.executable), str(path), *map(str, arguments)], step)
    try:
        return json.loads(text)
    except ValueError:
        return text
