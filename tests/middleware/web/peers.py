"""Peer programs, each in a separate process."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

_HERE = Path(__file__).parent
#: by the suffix of a program; all others are run by this Python
_RUNS = {".mjs": "node"}
LIMIT = 200.0
"""Wall-clock seconds after which the other side counts as lost."""


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
    with tempfile.TemporaryFile("w+") as said, tempfile.TemporaryFile("w+") as complaints:
        # files, because an unread pipe would block the peer
        command = [_RUNS.get(path.suffix, sys.executable), str(path), *map(str, arguments)]
        with subprocess.Popen(command, stdout=said, stderr=complaints) as other:
            end = time.monotonic() + LIMIT
            while other.poll() is None and time.monotonic() < end:
                step()
                time.sleep(0.002)  # leaves the processor to the other process
            other.kill()
        said.seek(0)
        complaints.seek(0)
        text = said.read()
        assert other.returncode == 0, text + complaints.read()
    try:
        return json.loads(text)
    except ValueError:
        return text
