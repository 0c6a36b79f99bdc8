"""Runs the ``morse`` command until the first tick: ``first_tick run --headless SCENE...``."""

from __future__ import annotations

import os

from morse.simulation.ticks.ticking import Ticker

_tick = Ticker.tick


def _only_one_tick(ticker: Ticker) -> None:
    _tick(ticker)
    print("first tick", flush=True)
    os._exit(0)


def main() -> None:
    """Run the command."""
    from morse.cli import main as morse

    Ticker.tick = _only_one_tick  # type: ignore[method-assign]
    morse()


if __name__ == "__main__":
    main()
