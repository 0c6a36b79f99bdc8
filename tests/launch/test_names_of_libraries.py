"""Files of a project with the names of libraries that a run does not need."""

import os
import subprocess
import sys
from pathlib import Path


def test_file_beside_the_scene_with_the_name_of_the_library_for_tables(tmp_path: Path):
    (tmp_path / "rich.py").write_text("")
    (tmp_path / "scene.py").write_text("from morse.builder import *\nrobot = ATRV()\nenv = Environment('empty')\n")
    command = [sys.executable, "-m", "morse", "run", "--headless", "--speed", "max", "--duration", "0.1", "scene.py"]
    environment = {**os.environ, "MORSE_SOCKET_PORT": "0"}
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120)
    assert (run.returncode, "Traceback" in run.stderr) == (0, False), run.stderr
