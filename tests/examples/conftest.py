import runpy
import threading

import pytest

import morse
from morse.cli.demo import example


@pytest.fixture
def run(monkeypatch):
    """Runs an example with its client, faster than real time, and returns the result of the client."""
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    # ticks that a busy machine delays are not run in a burst, in which robots would drive on before the client is heard
    monkeypatch.setattr("morse.simulation.ticks.pacing._GIVE_UP", 0.05)
    started = []

    def start(name, speed=4.0):
        chosen = example(name)
        simulation = morse.load(chosen.scene, sockets=True, speed=speed)
        thread = threading.Thread(target=simulation.run)
        thread.start()
        started.append((simulation, thread))
        (manager,) = simulation.context.services.request_managers().values()
        monkeypatch.setenv("MORSE_SOCKET_PORT", str(manager.port))
        found = runpy.run_path(str(chosen.client))["main"]()
        assert simulation.context.failed == set()
        return found

    yield start
    for simulation, thread in started:
        simulation.stop()
        thread.join(60.0)
        simulation.close()
