"""Message kinds of installed packages."""

import subprocess
import sys
from pathlib import Path

import pytest

KINDS = """
from morse.core.kinds import Kind, Slot
ECHO = Kind("echo", {"strength": Slot("strength", (None,), "float32")}, True, False, 1, "Strength over time.")
POSE = ECHO._replace(name="pose")
NOTHING = 7
"""
USE = """
import logging, numpy
logging.basicConfig()
from morse.core.sensor import Sensor
from morse.core.declarations import add_data, add_kind
class Sonar(Sensor):
    _name = "Sonar"
    add_data("echo", numpy.zeros(8, "float32"), "array", "Strength", shape=(8,), dtype="float32")
    add_kind("echo", strength="echo")
from types import SimpleNamespace
from morse.core.kinds import bind
sonar = Sonar.__new__(Sonar)
sonar.__dict__.update(
    local_data={"timestamp": 0.5, "echo": numpy.arange(8, dtype="float32")}, level=None,
    clock=SimpleNamespace(frequency=60.0, tick=30, time=0.5), output_modifiers=[], input_modifiers=[], realism=None,
    context=SimpleNamespace(clock=SimpleNamespace(frequency=60.0, tick=30, time=0.5)), name=lambda: "robot.sonar",
)
(kind,) = bind(sonar)
print(kind.kind.name, kind.kind.slots["strength"].dtype)
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder with an installed package."""
    for path, text in {
        "my_lab/__init__.py": KINDS,
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": (
            "[morse.kinds]\necho = my_lab:ECHO\npose = my_lab:POSE\n"
            "missing = my_lab:MISSING\nnothing = my_lab:NOTHING\n"
        ),
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def run(site: Path, program: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", f"import sys; sys.path.append({str(site)!r})\n" + program]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_a_component_speaks_a_kind_of_a_package_and_broken_ones_are_named(site: Path) -> None:
    done = run(site, USE)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "echo float32"
    assert "'pose' of my_lab:POSE already exists" in done.stderr
    assert "my_lab:MISSING cannot be loaded" in done.stderr
    assert "my_lab:NOTHING provides an object that is not a message kind" in done.stderr


def test_without_the_package_the_kind_is_unknown(tmp_path: Path) -> None:
    done = run(tmp_path, USE)
    assert "there is no message kind 'echo'" in done.stderr
