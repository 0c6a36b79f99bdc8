"""What a scene script does to the process, or raises, is a message that names its line."""

import subprocess
import sys
from pathlib import Path

import pytest

import morse
from morse.builder.errors import ScriptError

HEAD, END = "from morse.builder import *\nimport sys\n", '\nFakeRobot("r")\nenv = Environment("empty")\n'
ERRORS = {
    "no_exception": ("class Odd(BaseException): pass\nraise Odd('boo')", r":4: Odd: boo"),
    "generator_exit": ("raise GeneratorExit", r":3: GeneratorExit"),
    "without_a_message": (
        "class Odd(Exception):\n    def __str__(self): raise self\nraise Odd()",
        r":5: Odd: \(its message cannot be read\)",
    ),
    "type_error_without_a_message": (
        "class Odd(TypeError):\n    def __str__(self): return 7\nraise Odd()",
        r":5: Odd: \(its message cannot be read\)",
    ),
    "modifier": ("FakeRobot('x').alter(1.5, 2.5)", r":3: alter\(classpath\) takes a string, got 2.5"),
    "sensors": ("CompoundSensor(1)", r":3: CompoundSensor\(sensors\) takes a list of sensors, got 1"),
    "armature": ("Armature({})", r":3: Armature\(name\) takes a string, got {}"),
}


@pytest.mark.parametrize(("text", "expected"), ERRORS.values(), ids=ERRORS)
def test_an_error_of_any_class_names_its_line(text: str, expected: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_text(HEAD + text + END)
    with pytest.raises(ScriptError, match=expected):
        morse.load(path)


@pytest.mark.parametrize("text", ["sys.stdout.close()", "sys.stdout = sys.stderr = None"])
def test_a_script_without_a_standard_output_runs_to_its_end(text: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_text(HEAD + text + END)
    command = [sys.executable, "-m", "morse", "run", "--headless", "--duration", "0.05", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    if "close()" in text:
        assert "* the log can no longer be written: the standard output was closed" in done.stderr
