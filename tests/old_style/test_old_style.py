"""Test files in the style of MORSE 1.4 pass when they are run as programs, as the tests of 1.4 were."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SOURCE = HERE.parents[1] / "src"
FILES = sorted(HERE.glob("*_testing.py"))
#: run each time, in one time mode; the others at night, in both
SHORT = ("first_message", "pose", "services", "streams", "thermometer", "xy_omega")


def run(file: Path, directory: Path, *words: str) -> None:
    environment = {**os.environ, "PYTHONPATH": f"{SOURCE}{os.pathsep}{HERE}"}
    environment.pop("MORSE_SOCKET_PORT", None)
    ran = subprocess.run(
        [sys.executable, *words, file.stem if words else str(file)],
        cwd=directory,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr


@pytest.mark.parametrize("name", SHORT)
def test_in_one_time_mode(name: str, tmp_path: Path) -> None:
    run(HERE / f"{name}_testing.py", tmp_path, "-m", "unittest")


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem.removesuffix("_testing"))
def test_in_both_time_modes(file: Path, tmp_path: Path) -> None:
    run(file, tmp_path)
