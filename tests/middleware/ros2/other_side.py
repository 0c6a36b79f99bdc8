"""Processes that are on the other side of the middleware."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

_HERE = Path(__file__).parent
_LIMIT = 50.0
#: a Python that has rclpy, if it is not this one
PYTHON = os.environ.get("MORSE_TEST_ROS_PYTHON", sys.executable)
_PROMISED = {"rclpy": "MORSE_TEST_ROS_PYTHON", "cyclonedds": "CI"}

DOMAIN = 90 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw") or 0) % 10
"""Each worker of the tests has a ROS domain of its own."""


def environment(python: str) -> dict[str, str]:
    """The variables of a process on the other side."""
    dropped = ("PYTHONPATH", "CYCLONEDDS_URI") if python != sys.executable else ("CYCLONEDDS_URI",)
    return {name: value for name, value in os.environ.items() if name not in dropped}


@cache
def has(python: str, module: str) -> bool:
    """Whether a Python can import a module."""
    run = subprocess.run([python, "-c", f"import {module}"], capture_output=True, env=environment(python), check=False)
    return run.returncode == 0


def need(module: str, python: str = sys.executable) -> None:
    """Skip the test if there is no such module; where it was promised, the test has failed."""
    if not has(python, module):
        promised = os.environ.get(_PROMISED.get(module, ""))
        (pytest.fail if promised and python == PYTHON else pytest.skip)(f"{python} has no {module}")


def talk(script: str, step: Callable[[], object], python: str = sys.executable) -> dict[str, Any]:
    """Let time pass until a script has had enough; what it says."""
    with tempfile.TemporaryFile("w+") as said, tempfile.TemporaryFile("w+") as complaints:
        # files, since a pipe that nobody reads would hold up the other side
        command = [python, str(_HERE / script), str(DOMAIN)]
        with subprocess.Popen(command, stdout=said, stderr=complaints, env=environment(python)) as other:
            end = time.monotonic() + _LIMIT
            while other.poll() is None and time.monotonic() < end:
                step()
                time.sleep(0.005)  # so that the other process gets its turn
            if other.poll() is None:
                other.kill()
        for file in (said, complaints):
            file.seek(0)
        assert other.returncode == 0, complaints.read()
        result: dict[str, Any] = json.loads(said.read().splitlines()[-1])
    return result
