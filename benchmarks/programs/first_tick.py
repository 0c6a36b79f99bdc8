"""Runs the ``morse`` command until its simulation has done a tick: ``first_tick run --headless SCENE...``."""

from __future__ import annotations

import os

from morse.simulation.simulation import Simulation

_tick = Simulation.tick


def _only_one_tick(simulation: Simulation) -> None:
    _tick(simulation)
    print("first tick", flush=True)
    os._exit(0)


def main() -> None:
    """Run the command."""
    from morse.cli import main as morse

    Simulation.tick = _only_one_tick  # type: ignore[method-assign]
    morse()


if __name__ == "__main__":
    main()
