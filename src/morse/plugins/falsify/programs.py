"""Controllers that are programs of their own: each run starts one, which steps the simulation over its socket."""

from __future__ import annotations

import contextlib
import math
import os
import subprocess
import tempfile
import threading
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import quoted

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from morse import Simulation

#: where clients find the services, as `pymorse.Morse` does; 0 for any free port
_PORT = "MORSE_SOCKET_PORT"
#: wall-clock time in which a program ends that is told to, s
_GRACE = 2.0
#: what is read of the end of its error output, bytes
_LAST = 2000


class ProgramError(MorseError):
    """A program has failed: it cannot be started, or ends with a status other than 0."""


@contextlib.contextmanager
def any_port() -> Iterator[None]:
    """Let the simulations of this process, and of those that it starts, listen on any free port."""
    before = os.environ.get(_PORT)
    os.environ[_PORT] = "0"
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(_PORT, None)
        else:
            os.environ[_PORT] = before


def run(simulation: Simulation, program: Sequence[str], parameters: Mapping[str, object], duration: float) -> None:
    """Run a program with a simulation that is paused, so that each tick is one that the program asks for.

    Args:
        program: its words; ``{name}`` stands for the value of a parameter.
        duration: simulated time after which the run ends, and the program with it, s.

    Raises:
        ProgramError: see there; the message contains the end of what it wrote as errors.
    """
    words = [word.format(**parameters) for word in program]
    environment = {**os.environ, _PORT: str(_port(simulation))}
    simulation.pause()
    with tempfile.TemporaryFile() as errors:
        try:
            child = subprocess.Popen(
                words, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors
            )
        except OSError as error:
            raise ProgramError(f"{quoted(words[0])} cannot be started: {error}") from None
        ended = threading.Event()
        watch = threading.Thread(target=_watch, args=(simulation, child, ended), daemon=True, name="watch of a program")
        watch.start()
        try:
            remaining = round(duration * simulation.clock.frequency) - simulation.ticks
            while remaining > 0 and not ended.is_set():
                simulation.run(remaining / simulation.clock.frequency, speed=math.inf)
                remaining = round(duration * simulation.clock.frequency) - simulation.ticks
        finally:
            has_ended = ended.is_set()
            _end(child)
            watch.join(_GRACE)
            simulation.resume()
        if has_ended and child.returncode:
            errors.seek(max(0, errors.seek(0, os.SEEK_END) - _LAST))
            text = errors.read().decode("utf-8", "replace").strip()
            raise ProgramError(f"the program has ended with status {child.returncode}: {text.splitlines()[-1:] or ''}")


def _watch(simulation: Simulation, child: subprocess.Popen[bytes], ended: threading.Event) -> None:
    """End the run when the program has ended."""
    child.wait()
    ended.set()
    simulation.stop()


def _end(child: subprocess.Popen[bytes]) -> None:
    if child.poll() is None:
        child.terminate()
        try:
            child.wait(_GRACE)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()


def _port(simulation: Simulation) -> int:
    """The port of the services of a simulation."""
    managers: Any = simulation.context.services.request_managers().values()
    for manager in managers:
        port = getattr(manager, "port", 0)
        if port:
            return int(port)
    raise ProgramError(
        'the scene has no services on a socket: robot.add_default_interface("socket"), or '
        'options={"interfaces": ["socket"]}'
    )
