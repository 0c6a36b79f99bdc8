"""Runs a scene for some ticks and writes the fingerprint of every part after each of them.

``python -m morse.verification.replay OPTIONS`` is what `morse.verification.verify` starts; OPTIONS is
JSON: the fields of a `Replay`. One JSON object a tick goes to its file ``output``.
"""

from __future__ import annotations

import json
import sys
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.core import log
from morse.simulation.digest import fingerprints
from morse.simulation.options import RunOptions
from morse.simulation.simulation import Simulation
from morse.simulation.viewing import View
from morse.verification.onlookers import Onlookers

if TYPE_CHECKING:
    from typing import TextIO

#: a run that is paced by the wall clock takes no longer than that, s
_PACED = 3.0


@dataclass(frozen=True, slots=True)
class Replay:
    """What to run.

    Attributes:
        options: fields of `RunOptions`.
        ticks: length of each run.
        output: file to write.
        restarts: how often to start anew afterwards.
        clients: readers of every stream.
        pages: of the live view, if the options ask for one.
        paced: wait for the wall clock between ticks.
    """

    options: dict[str, Any]
    ticks: int
    output: str
    restarts: int = 0
    clients: int = 0
    pages: int = 1
    paced: bool = False


def replay(wanted: Replay) -> None:
    """Write the fingerprints of ``1 + restarts`` runs, one after the other."""
    options = RunOptions(**wanted.options)
    scene = load_scene(options)
    resolve_shapes(scene)
    simulation = Simulation(scene, options)
    try:
        simulation.load()
        if options.view != "none":
            simulation.view = View(simulation)
            simulation.view.announce()
        watched = bool(wanted.clients or simulation.view)
        with (
            Onlookers(simulation, wanted.clients, wanted.pages) if watched else nullcontext(),
            Path(wanted.output).open("w", encoding="utf-8") as file,
        ):
            for run in range(1 + wanted.restarts):
                if run:
                    simulation.restart()
                _run(simulation, wanted, file)
    finally:
        simulation.shut_down()


def _run(simulation: Simulation, wanted: Replay, file: TextIO) -> None:
    pacer = simulation.pacer
    if wanted.paced:
        pacer.set_speed(max(1.0, wanted.ticks * simulation.clock.period / _PACED))
    for _ in range(wanted.ticks):
        simulation.tick()
        file.write(json.dumps(fingerprints(simulation.context)) + "\n")
        if wanted.paced:
            pacer.wait()


def main(argument: str) -> None:
    """Run what the JSON text says."""
    log.setup(level="ERROR")
    replay(Replay(**json.loads(argument)))


if __name__ == "__main__":
    main(sys.argv[1])
