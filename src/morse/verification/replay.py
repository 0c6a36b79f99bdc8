"""Runs a scene for some ticks and writes the fingerprint of every part after each of them.

`morse.verification.verify` starts ``python -m morse.verification.replay OPTIONS``; OPTIONS is JSON: the fields of a
`Replay`. One JSON object per tick is written to the standard output, and at last a text that names the parts that have
failed; output of the scene is redirected to the standard error. The process ends with its parent process, because its
standard input is closed then.
"""

from __future__ import annotations

import io
import json
import os
import sys
import threading
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.builder.script import ScriptError, load_scene
from morse.core.exceptions import MorseError
from morse.core.guard import by_part
from morse.core.reports import log
from morse.core.reports.faults import describe
from morse.core.reports.printing import echo
from morse.launch.load import start
from morse.physics import UnstableError
from morse.simulation.options import RunOptions
from morse.system.own_programs import own_output
from morse.verification.passive_clients import PassiveClients

if TYPE_CHECKING:
    from typing import TextIO

    from morse.core.values import Options
    from morse.simulation.simulation import Simulation

#: timeout of a run in step with the wall clock, s
_PACED = 3.0


@dataclass(frozen=True, slots=True)
class Replay:
    """The options of a replay.

    Attributes:
        options: fields of `RunOptions`.
        ticks: length of each run; None for the duration of the options.
        restarts: number of restarts afterwards.
        clients: readers of every stream.
        pages: number of pages of the live view, if the options open one.
        paced: wait for the wall clock between ticks.
    """

    options: Options
    ticks: int | None
    restarts: int = 0
    clients: int = 0
    pages: int = 1
    paced: bool = False


def replay(request: Replay, file: TextIO) -> None:
    """Write the fingerprints of ``1 + restarts`` runs, one after the other."""
    options = RunOptions(**request.options)
    with start(load_scene(options), options) as simulation:
        if simulation.view is not None:
            simulation.view.announce()
        watched = bool(request.clients or simulation.view)
        with PassiveClients(simulation, request.clients, request.pages) if watched else nullcontext():
            for run in range(1 + request.restarts):
                if run:
                    simulation.restart()
                _run(simulation, request, file)
    file.write(json.dumps(by_part(one for one in simulation.failures if one.kind == "fault")) + "\n")


def _run(simulation: Simulation, request: Replay, file: TextIO) -> None:
    pacer = simulation.pacer
    seconds = simulation.options.duration or 0.0
    ticks = max(1, round(seconds * simulation.clock.frequency)) if request.ticks is None else request.ticks
    if request.paced:
        pacer.set_speed(max(1.0, ticks * simulation.clock.period / _PACED))
    for _ in range(ticks):
        simulation.tick()
        file.write(json.dumps(simulation.save().fingerprints()) + "\n")
        if request.paced:
            pacer.wait()


def main(argument: str) -> None:
    """Run the replay of a JSON text."""
    _end_with_the_parent()
    own = own_output()
    log.setup(level="ERROR")
    with io.TextIOWrapper(io.BufferedWriter(own), encoding="utf-8") as file:
        try:
            replay(Replay(**json.loads(argument)), file)
        except (MorseError, UnstableError, ValueError, OSError, SystemExit) as error:
            # a mistake in the scene, as `morse run` reports it
            echo(_report(error), err=True)
            sys.exit(1)


def _report(error: BaseException) -> str:
    if isinstance(error, ScriptError):
        return error.report()
    return str(error) if isinstance(error, MorseError) else describe(error)


def _end_with_the_parent() -> None:
    alive = os.dup(0)
    # scenes may read: they get the end of the file
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)

    def wait() -> None:
        while os.read(alive, 1):
            pass
        os._exit(1)

    threading.Thread(target=wait, name="parent", daemon=True).start()


if __name__ == "__main__":
    main(sys.argv[1])
