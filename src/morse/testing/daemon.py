"""Runs the server of a middleware during a test."""

from __future__ import annotations

import contextlib
import shutil
import socket
import subprocess
import time
from typing import TYPE_CHECKING

from morse.testing.exceptions import MorseTestingError

if TYPE_CHECKING:
    from collections.abc import Sequence

_START_TIMEOUT = 60.0
_END_TIMEOUT = 5.0
_PERIOD = 0.05


class Daemon:
    """A server on a TCP port of this machine.

    A server that already listens there is used, and is left running.

    Args:
        command: program and arguments.
        port: port on which the server listens.
        hint: instruction for installing the program, for the error message if it is missing.
        timeout: timeout for the start of the server, s.

    Raises:
        MorseTestingError: the program is not on the PATH, ends, or does not listen in time.
    """

    def __init__(self, command: Sequence[str], port: int, hint: str, timeout: float = _START_TIMEOUT) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        if _listens(port):
            return
        program = shutil.which(command[0])
        if program is None:
            raise MorseTestingError(f"the test needs the program '{command[0]}', which is not on the PATH: {hint}")
        self._process = subprocess.Popen(
            [program, *command[1:]], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        deadline = time.monotonic() + timeout
        while not _listens(port):
            status = self._process.poll()
            if status is not None:
                raise MorseTestingError(f"'{' '.join(command)}' ended with status {status}")
            if time.monotonic() > deadline:
                self.stop()
                raise MorseTestingError(f"'{' '.join(command)}' did not listen on port {port} within {timeout:g} s")
            time.sleep(_PERIOD)

    def stop(self) -> None:
        """End the server, if this object started it."""
        process, self._process = self._process, None
        if process is None:
            return
        for end in (process.terminate, process.kill):
            end()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_END_TIMEOUT)
                return


def _listens(port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1.0):
        return True
    return False
