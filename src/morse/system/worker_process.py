"""Worker processes on this machine: messages through pipes, and limits of what they may use."""

from __future__ import annotations

import contextlib
import os
import signal
import struct
import subprocess
import sys
import threading
from typing import IO, TYPE_CHECKING, NoReturn

from morse.system.own_programs import command

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

#: wall-clock time after which a worker that does not end is killed, and one that does not answer, s
_GRACE, PATIENCE = 5.0, 60.0
_LENGTH = struct.Struct("<Q")
#: bytes of the largest message; a length beyond it is no length, but something else that was written into the pipe
_MOST = 1 << 32
#: variables without which a program does not start on some systems
_NEEDED = ("SYSTEMROOT", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")


class WorkerProcess:
    """A process that answers messages.

    It is a program of its own, not a copy of this process: the simulation may have threads and sockets, and its program
    needs no ``if __name__ == "__main__"``.

    Args:
        module: its program.
        environment: its environment variables.
        patience: wall-clock time of an answer, s.
        is_silent: whether what it prints is dropped.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(
        self, module: str, environment: Mapping[str, str], patience: float | None = None, *, is_silent: bool = False
    ) -> None:
        self._patience = patience
        self._process = subprocess.Popen(
            command(module),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL if is_silent else None,
            bufsize=0,
            env=environment,
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
        overdue = threading.Timer(PATIENCE if self._patience is None else self._patience, self._process.kill)
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


def serve(answer: Callable[[bytearray], bytes | bytearray]) -> NoReturn:
    """Answer the messages of the process that has started this one: from the standard input, to the standard output.

    This process ends with its input: the other one closes the pipe, or has died.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the simulation ends the workers
    answers = os.fdopen(os.dup(1), "wb", 0)
    # what a library prints must not get between the answers
    os.dup2(2, 1)
    messages = sys.stdin.buffer
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            send(answers, answer(receive(messages)))
    # without the finalisation of Python, which would flush a closed pipe
    os._exit(0)


def bare_environment() -> dict[str, str]:
    """The environment of a process that reads files of anybody: nothing of the user, only where the modules are."""
    needed = {name: os.environ[name] for name in _NEEDED if name in os.environ}
    return {**needed, "PYTHONPATH": os.pathsep.join(path for path in sys.path if os.path.isabs(path))}


def limit_resources(seconds: float, memory: int) -> None:
    """Limit the processor time and the memory, bytes, of this process, where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def send(pipe: IO[bytes], message: bytes | bytearray) -> None:
    """Write a message, after its length.

    Raises:
        BrokenPipeError: nobody reads.
    """
    for part in (_LENGTH.pack(len(message)), message):
        rest = memoryview(part)
        while rest:
            rest = rest[pipe.write(rest) :]
    pipe.flush()


def receive(pipe: IO[bytes]) -> bytearray:
    """Read a message.

    Raises:
        EOFError: the other end is closed, or writes something else.
    """
    (length,) = _LENGTH.unpack(_read(pipe, _LENGTH.size))
    if length > _MOST:
        raise EOFError(f"a message of {length} bytes is announced")
    return _read(pipe, length)


def _read(pipe: IO[bytes], length: int) -> bytearray:
    message = bytearray(length)
    rest = memoryview(message)
    while rest:
        count = pipe.readinto(rest)  # type: ignore[attr-defined] # a file of bytes
        if not count:
            raise EOFError
        rest = rest[count:]
    return message


def _pipe(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None
    return pipe
