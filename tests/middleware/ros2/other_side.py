"""Peer processes of the middleware."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.kit import programs

_HERE = Path(__file__).parent
_LIMIT = 100.0
_MADE = _HERE.parents[2] / ".venv-ros/bin/python"
#: a Python with rclpy: this one, that of the variable, or that of .ci/ros2
PYTHON = (
    sys.executable
    if importlib.util.find_spec("rclpy")
    else os.environ.get("MORSE_TEST_ROS_PYTHON") or (str(_MADE) if _MADE.exists() else sys.executable)
)
#: variables that change how peers discover each other; tests with a value of a user prove nothing
SETTINGS = ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS")


#: a ROS domain that no other process of tests on this machine uses
DOMAIN = int(os.environ["ROS_DOMAIN_ID"])


def environment(python: str) -> dict[str, str]:
    """The environment variables of a peer process: those of a user who has set none for ROS."""
    kept = {name: value for name, value in os.environ.items() if name not in SETTINGS}
    if python != sys.executable:
        kept.pop("PYTHONPATH", None)
    return kept


def lent() -> dict[str, str]:
    """The variables that add the packages of this Python to the other Python."""
    import morse

    # pytest may be in a place that the environment of this Python adds
    paths = [str(Path(morse.__file__).parents[1]), sysconfig.get_path("purelib"), str(Path(pytest.__file__).parents[1])]
    return {**environment(PYTHON), "PYTHONPATH": os.pathsep.join(paths)}


@cache
def has(python: str, module: str) -> bool:
    """Whether a Python can import a module."""
    if python == sys.executable and importlib.util.find_spec(module) is None:
        return False
    run = subprocess.run([python, "-c", f"import {module}"], capture_output=True, env=environment(python), check=False)
    return run.returncode == 0


def need(module: str, python: str = sys.executable) -> None:
    """Skip the test if the module is missing; in CI the test fails."""
    if not has(python, module):
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{python} has no {module}: see .ci/ros2")


def talk(script: str, step: Callable[[], object], python: str = sys.executable) -> dict[str, Any]:
    """Step until a script ends; returns the last line of its output."""
    text = programs.talk([python, str(_HERE / script), str(DOMAIN)], step, environment(python))
    result: dict[str, Any] = json.loads(text.splitlines()[-1])
    return result
