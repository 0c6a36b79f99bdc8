"""The output of create and add can be simulated without changes."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import morse

SOURCES = str(Path(morse.__file__).parents[1])


def morse_run(home, *words, said=""):
    environment = {**os.environ, "HOME": str(home), "USERPROFILE": str(home), "PYTHONPATH": SOURCES}
    return subprocess.run(
        [sys.executable, "-c", "from morse.cli import main; main()", *words],
        env=environment,
        cwd=home,
        input=said,
        capture_output=True,
        encoding="utf-8",
        timeout=90,
        check=False,
    )


def test_a_new_environment_runs(tmp_path):
    assert morse_run(tmp_path, "create", "ranger_sim").returncode == 0
    result = morse_run(tmp_path, "run", "--headless", "--speed", "max", "--duration", "0.5", "ranger_sim")
    assert result.returncode == 0, result.stdout + result.stderr
    lines = [re.sub(r"^\[ *\d+\.\d{3}\] ", "", line) for line in result.stdout.splitlines()]
    for line in ("\tROBOT: 'robot'", *(f"\t\t- Component: 'robot.{c}'" for c in ("motion", "keyboard", "pose"))):
        assert line in lines
    assert lines[-1] == "[EXITING SIMULATION]"
    assert "[ERROR]" not in result.stdout


def test_the_test_of_a_new_environment_passes(tmp_path):
    assert morse_run(tmp_path, "create", "ranger_sim").returncode == 0
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"],
        cwd=tmp_path / "ranger_sim",
        env={**environment, "PYTHONPATH": SOURCES},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("kind", ["sensor", "actuator"])
def test_components_of_ones_own_run(tmp_path, kind):
    morse_run(tmp_path, "create", "sim")
    assert morse_run(tmp_path, "add", "robot", "ranger", "sim").returncode == 0
    assert morse_run(tmp_path, "add", kind, "eyes", "sim").returncode == 0
    (tmp_path / "sim" / "default.py").write_text(
        "from morse.builder import *\n"
        "from sim.builder.robots import Ranger\n"
        f"from sim.builder.{kind}s import Eyes\n"
        "robot = Ranger()\n"
        "eyes = Eyes()\n"
        "robot.append(eyes)\n"
        "robot.add_default_interface('socket')\n"
        "env = Environment('sandbox', fastmode=False)\n"
    )
    result = morse_run(tmp_path, "run", "--headless", "--speed", "max", "--duration", "0.5", "sim")
    assert result.returncode == 0, result.stdout + result.stderr
    for component in ("eyes", "motion", "keyboard", "pose"):
        assert f"- Component: 'robot.{component}'" in result.stdout
    assert f"[{kind}s.eyes] robot.eyes initialization" in result.stdout
    assert "[robots.ranger] robot initialization" in result.stdout
    assert "[ERROR]" not in result.stdout


@pytest.mark.parametrize("kind", ["sensor", "actuator"])
def test_a_new_component_keeps_the_contract(tmp_path, kind):
    morse_run(tmp_path, "create", "sim")
    added = morse_run(tmp_path, "add", kind, "eyes", "sim", said="Looks around\n")
    (command,) = (line for line in added.stdout.splitlines() if "morse check component" in line)
    result = morse_run(tmp_path, *command.partition("morse ")[2].split())
    assert result.returncode == 0, result.stdout + result.stderr
