"""A real YARP, built by .ci/yarp: its name server and its Python bindings, in other processes."""

import contextlib
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

HERE = Path(__file__).parent
YARP = Path(os.environ.get("MORSE_TEST_YARP") or HERE.parents[2] / ".yarp")
LIMIT = 60.0


def need_yarp() -> None:
    """Skip the test without YARP; in CI the test fails."""
    if not (YARP / "bin/yarpserver").exists():
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"there is no YARP in {YARP}: run .ci/yarp")


def _free_port() -> int:
    # the server gives the next ports to its clients: below those that the system gives to others
    for port in range(15000 + os.getpid() % 100 * 100, 30000, 100):
        with contextlib.suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise RuntimeError("no port is free")


class Yarp:
    """A name server on a free port of 127.0.0.1.

    Args:
        folder: for its configuration, which its clients read.
    """

    def __init__(self, folder: Path) -> None:
        need_yarp()
        self.port = _free_port()
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("YARP_")},
            "LD_LIBRARY_PATH": str(YARP / "lib"),
            "PYTHONPATH": str(YARP / "python"),
            **{name: str(folder) for name in ("YARP_CONF", "XDG_CONFIG_HOME", "XDG_DATA_HOME")},
        }
        options = ["--ip", "127.0.0.1", "--socket", str(self.port), "--portdb", ":memory:", "--subdb", ":memory:"]
        self._log = folder / "yarpserver.log"
        with self._log.open("w") as log:
            command = [str(YARP / "bin/yarpserver"), *options, "--write"]
            self._server = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
        end = time.monotonic() + LIMIT
        while "Port /root active" not in self._log.read_text():
            assert time.monotonic() < end, self._log.read_text()
            assert self._server.poll() is None, self._log.read_text()
            time.sleep(0.01)

    def start(self, *command: str, **options: object) -> subprocess.Popen[str]:
        """Start a program of YARP, such as ``yarp name list``."""
        found = [str(YARP / "bin" / command[0]), *command[1:]]
        return subprocess.Popen(
            found, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def python(self, *command: str) -> subprocess.Popen[str]:
        """Start a Python script with the bindings."""
        given = [sys.executable, *command]
        return subprocess.Popen(given, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def close(self) -> None:
        self._server.kill()
        self._server.wait()
