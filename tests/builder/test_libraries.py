"""Files of the user with the name of a library."""

import subprocess
import sys
from pathlib import Path

import pytest

# -P: only the folder of the script is on the path, as for the installed command
MORSE = (sys.executable, "-P", "-c", "import sys; from morse.cli import main; sys.exit(main())")
SCENE = """from morse.builder import *
import helper
robot = ATRV()
assert helper.TEXT == "of the user"
env = Environment("empty")
"""


NAMES = ["mujoco", "random", "mathutils", "morse"]
MORE = ["rich", "email", "test", "numpy", "scene"]


# a name of each kind, and others of the same kinds
@pytest.mark.parametrize("name", [*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)])
def test_a_script_may_be_called_like_any_library(name: str, tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("TEXT = 'of the user'\n")
    (tmp_path / "tempfile.py").write_text("raise RuntimeError('not the one of the standard library')\n")
    (tmp_path / f"{name}.py").write_text(SCENE)
    command = [*MORSE, "run", "--headless", "--duration", "0.1", f"{name}.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "[EXITING SIMULATION]" in done.stdout
