from __future__ import annotations

import sys

import pytest
from ticking import Ticking


@pytest.fixture
def simulate(tmp_path, monkeypatch):
    """Creates simulations from scene scripts; tests run their ticks."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    monkeypatch.setattr(sys, "argv", sys.argv[:])
    monkeypatch.setattr(sys, "path", sys.path[:])
    made = []

    def make(script, **options):
        made.append(Ticking(script, tmp_path / f"scene{len(made)}.py", **options))
        return made[-1]

    yield make
    for simulation in made:
        simulation.close()
