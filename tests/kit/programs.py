"""Other programs in tests: their ports, their results, and those that a simulation talks with."""

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

#: s, after which a program counts as lost
_LIMIT = 200.0


def free_ports(count: int, kind: socket.SocketKind = socket.SOCK_STREAM) -> list[int]:
    """Ports of 127.0.0.1 that no program uses now."""
    probes = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    try:
        for probe in probes:
            probe.bind(("127.0.0.1", 0))
        return [probe.getsockname()[1] for probe in probes]
    finally:
        for probe in probes:
            probe.close()


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """A port of 127.0.0.1 that no program uses now."""
    return free_ports(1, kind)[0]


def python(
    *words: object, folder: Path | None = None, limit: float = 240.0, **more: object
) -> subprocess.CompletedProcess[str]:
    """Run Python with some arguments, and return its result with its output as texts.

    Args:
        folder: its working folder.
        limit: s; it is killed later.
        more: variables of its environment, in addition to those of this process.
    """
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=folder,
        env={**os.environ, **{name: str(value) for name, value in more.items()}},
        capture_output=True,
        encoding="utf-8",
        timeout=limit,
        check=False,
    )


def talk(command: list[str], step: Callable[[], object], environment: Mapping[str, str] | None = None) -> str:
    """Run a program, call a function until it has ended, and return its output.

    Raises:
        AssertionError: it fails, with what it says.
    """
    with tempfile.TemporaryFile("w+") as said, tempfile.TemporaryFile("w+") as complaints:
        # files, because an unread pipe would block the program
        with subprocess.Popen(command, stdout=said, stderr=complaints, env=environment) as other:
            end = time.monotonic() + _LIMIT
            try:
                while other.poll() is None and time.monotonic() < end:
                    step()
                    time.sleep(0.002)  # leaves the processor to the program
            finally:
                other.kill()
        for file in (said, complaints):
            file.seek(0)
        text = said.read()
        assert other.returncode == 0, text + complaints.read()
    return text
