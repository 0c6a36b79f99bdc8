"""Runs a scene for some ticks and writes the fingerprint of every part after each of them.

``python -m morse.verification.replay OPTIONS`` is what `morse.verification.verify` starts; OPTIONS is
JSON: the fields of `RunOptions`, ``ticks``, and ``restarts``, how often to start anew afterwards.
One JSON object a tick goes to the file ``output``.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.core import log
from morse.simulation.digest import fingerprints
from morse.simulation.options import RunOptions
from morse.simulation.simulation import Simulation
from morse.simulation.viewing import open_view


def replay(options: RunOptions, ticks: int, restarts: int, output: Path) -> None:
    """Write the fingerprints of ``1 + restarts`` runs of ``ticks`` ticks, one after the other."""
    scene = load_scene(options)
    resolve_shapes(scene)
    simulation = Simulation(scene, options)
    try:
        simulation.load()
        simulation.view = open_view(simulation)
        if simulation.view is not None:
            simulation.view.announce()
        with output.open("w") as file:
            for again in range(1 + restarts):
                if again:
                    simulation.restart()
                for tick in range(1, ticks + 1):
                    simulation.tick()
                    file.write(
                        json.dumps({"run": again, "tick": tick, "parts": fingerprints(simulation.context)}) + "\n"
                    )
    finally:
        simulation.shut_down()


def main(argument: str) -> None:
    """Run what the JSON text says."""
    wanted: dict[str, Any] = json.loads(argument)
    log.setup(level="ERROR")
    replay(RunOptions(**wanted["options"]), wanted["ticks"], wanted["restarts"], Path(wanted["output"]))


if __name__ == "__main__":
    main(sys.argv[1])
