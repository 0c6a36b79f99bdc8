"""A worker process on this machine."""

from __future__ import annotations

import contextlib
import os
import subprocess
import threading
from typing import TYPE_CHECKING

from morse.kernel import threads
from morse.rendering.workers.pipes import receive, send
from morse.system.own_programs import command

if TYPE_CHECKING:
    from typing import IO

#: wall-clock time after which a worker that does not end is killed, and one that does not answer, s
_GRACE, PATIENCE = 5.0, 60.0


class WorkerProcess:
    """A process that draws with one thread.

    It is a program of its own, not a copy of this process: the simulation may have threads and sockets, and its program
    needs no ``if __name__ == "__main__"``.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            command("morse.rendering.workers.main"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            env={**os.environ, threads.VARIABLE: "1"},
        )

    @property
    def pid(self) -> int:
        """The number of the process."""
        return self._process.pid

    def ask(self, message: bytes) -> bytes | bytearray:
        """Send a message and wait for the answer.

        Raises:
            EOFError, OSError: the process has ended, or was killed because it did not answer.
        """
        # a process may be stopped, and then neither reads nor writes
        overdue = threading.Timer(PATIENCE, self._process.kill)
        overdue.daemon = True
        overdue.start()
        try:
            send(_pipe(self._process.stdin), message)
            return receive(_pipe(self._process.stdout))
        finally:
            overdue.cancel()

    def close(self) -> None:
        """End the process."""
        for pipe in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                _pipe(pipe).close()
        try:
            self._process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None
    return pipe
