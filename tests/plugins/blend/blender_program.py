"""The Blender of this machine."""

import shutil
import subprocess
from pathlib import Path

import pytest


def run_blender(script: Path, *arguments: str) -> None:
    """Run a script; skip the test without Blender."""
    program = shutil.which("blender")
    if program is None:
        pytest.skip("needs Blender on the PATH")
    command = [program, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "3", "--python", str(script), "--"]
    subprocess.run([*command, *arguments], check=True, timeout=100, stdin=subprocess.DEVNULL, capture_output=True)
