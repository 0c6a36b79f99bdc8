"""Ctrl+C ends a simulation cleanly at any time."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="a console sends Ctrl+C in another way there")

# the interruption arrives while a library is initialised that cannot handle it
_INTERRUPTED = """
import os, signal, sys
import {module}
original = {place}
def interrupted(*args, **kwargs):
    os.kill(os.getpid(), signal.SIGINT)
    return original(*args, **kwargs)
{place} = interrupted
from morse.cli import main
sys.argv = ["morse", "run", "--headless", "--duration", "60", "scene.py"]
main()
"""
# like a compiled module: it converts an interruption into an ImportError
_WHILE_IMPORTING = """
import builtins, os, signal, sys
original = builtins.__import__
def importing(name, *args, **kwargs):
    if name == "mujoco" and "mujoco" not in sys.modules:
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("initialization failed")
    return original(name, *args, **kwargs)
builtins.__import__ = importing
from morse.cli import main
sys.argv = ["morse", "run", "--headless", "--duration", "60", "scene.py"]
main()
"""


@pytest.mark.parametrize(
    ("program", "status"),
    [
        (_WHILE_IMPORTING, 130),
        (_INTERRUPTED.format(module="asyncio", place="asyncio.SelectorEventLoop.__init__"), 0),
    ],
    ids=["importing", "beginning"],
)
def test_an_interruption_while_the_simulation_is_set_up(tmp_path: Path, program: str, status: int) -> None:
    (tmp_path / "scene.py").write_text("from morse.builder import *\nrobot = ATRV()\nenv = Environment('empty')\n")
    ended = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "MORSE_SOCKET_PORT": "0", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert "Traceback" not in ended.stdout + ended.stderr
    assert ended.returncode == status
