"""Runs a simulation in a separate process."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from morse.simulation.ending import FAULTS
from morse.testing.exceptions import MorseTestingError
from morse.testing.follow import EXITING, LogWatch

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


# Runs the server of a middleware during a test.

_START_TIMEOUT = 60.0
_DAEMON_TIMEOUT = 5.0
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
                process.wait(_DAEMON_TIMEOUT)
                return


def _listens(port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1.0):
        return True
    return False


#: environment variable with the port for simulations and clients
PORT_VARIABLE = "MORSE_SOCKET_PORT"
# a machine that runs many tests at once may be busy: only what hangs takes as long as this
START_TIMEOUT = 60.0
_END_TIMEOUT = 30.0
_KILL_TIMEOUT = 5.0
_SOURCES = Path(__file__).resolve().parents[2]


def _ignore(_: str) -> None: ...


class SimulationProcess:
    """A simulation that runs a scene script, and writes its log to a file.

    Args:
        script: path of the scene script.
        log: path of the log; overwritten.
        port: preferred port for its services; 0 for any free port.
        options: options of ``morse run``.
        on_error: callback, called with the line if the log reports an error while the simulation runs.
        fails: names of the parts that are expected to fail, such as ``robot.gps``.
    """

    def __init__(
        self,
        script: Path,
        log: Path,
        *,
        port: int = 0,
        options: Sequence[str] = ("--headless",),
        on_error: Callable[[str], None] = _ignore,
        fails: Sequence[str] = (),
    ) -> None:
        self.log = log
        environment = {**os.environ, PORT_VARIABLE: str(port)}
        # the tests may run from a source tree that is not installed
        paths = [str(_SOURCES), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment["PYTHONPATH"] = os.pathsep.join(paths)
        with log.open("wb") as output:
            self._process = subprocess.Popen(
                [*morse_command(), "run", *options, str(script)],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=environment,
            )
        self.watch = LogWatch(log, lambda: self._process.poll() is not None, on_error, fails)
        self.watch.start()

    @property
    def pid(self) -> int:
        """Process id of the simulation."""
        return self.watch.pid or self._process.pid

    @property
    def port(self) -> int:
        """TCP port of its services.

        Raises:
            MorseTestingError: the log does not contain it.
        """
        if self.watch.port is None:
            raise MorseTestingError(f"the log of the simulation does not contain the port of its services ({self.log})")
        return self.watch.port

    def wait_initialized(self, timeout: float = START_TIMEOUT) -> None:
        """Wait until the simulation runs.

        Raises:
            MorseTestingError: the simulation reported an error, ended, or takes too long; it is then stopped.
        """
        if self.watch.wait(lambda: self.watch.initialized or self.watch.error is not None, timeout):
            if self.watch.error is None:
                return
            what = f"the simulation did not start: {self.watch.error}"
        elif self._process.poll() is not None:
            what = f"the simulation ended while it was loaded, with status {self._process.returncode}"
        else:
            what = f"the simulation did not start within {timeout:g} s"
        self.kill()
        raise self._failure(what)

    def wait_refused(self, timeout: float = START_TIMEOUT) -> str:
        """Wait until the simulation reports an error in its scene, and return that line.

        Raises:
            MorseTestingError: the simulation started, ended without an error, or takes too long.
        """
        self.watch.wait(lambda: self.watch.initialized or self.watch.error is not None, timeout)
        if self.watch.error is None:
            self.kill()
            raise self._failure("an error in the scene was expected, and none was reported")
        self.watch.join(_END_TIMEOUT)
        self.kill()
        return self.watch.error

    def stop(self) -> None:
        """End the simulation, through its service if the service responds, and wait for the end.

        Raises:
            MorseTestingError: the simulation had to be killed, or failed, other than by faults that ``watch.errors``
                contains.
        """
        is_asked = self._process.poll() is not None or self._ask_to_quit()
        # a simulation that is ending may not respond
        self.watch.join(_END_TIMEOUT if is_asked else _KILL_TIMEOUT)
        if self._process.poll() is None:
            self.kill()
            raise self._failure("the simulation did not end when requested, and was killed")
        status = self._process.returncode
        ended_well = any(EXITING in line for line in self.watch.tail)
        if (status and not (status == FAULTS and self.watch.errors)) or not ended_well:
            raise self._failure(f"the simulation failed, with status {status}")

    def _ask_to_quit(self) -> bool:
        try:
            with socket.create_connection(("127.0.0.1", self.port), timeout=_KILL_TIMEOUT) as connection:
                connection.sendall(b"id1 simulation quit\n")
        except (OSError, MorseTestingError):
            return False
        return True

    def kill(self) -> None:
        """Terminate the process, and kill it if necessary."""
        for end in (self._process.terminate, self._process.kill):
            if self._process.poll() is None:
                end()
                try:
                    self._process.wait(_KILL_TIMEOUT)
                except subprocess.TimeoutExpired:
                    continue
        self.watch.join(_KILL_TIMEOUT)

    def _failure(self, what: str) -> MorseTestingError:
        return MorseTestingError(f"{what}\nThe end of {self.log}:\n{self.watch.excerpt()}")


def morse_command() -> list[str]:
    """The words that run the command ``morse``."""
    root = os.environ.get("MORSE_ROOT")
    if root is not None and (command := Path(root) / "bin" / "morse").is_file():
        return [str(command)]
    return [sys.executable, "-c", "from morse.cli import main; main()"]


def preferred_port(port: int) -> int:
    """Return ``port`` if no server listens on it, otherwise 0 for any free port."""
    with socket.socket() as probe:
        if os.name == "posix":
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
            probe.listen()
        except OSError:
            return 0
    return port
