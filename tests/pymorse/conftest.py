import threading
from collections.abc import Iterator

import pytest
from scripted_simulation import ScriptedSimulation

from tests.kit.waiting import wait_until


def client_threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("pymorse")]


@pytest.fixture
def simulation() -> Iterator[ScriptedSimulation]:
    """The simulation of the transcript: robot1 with a pose sensor and a motion actuator."""
    robots = {"robot1": {"robot1.pose": (["get_local_data"], "OUT"), "robot1.motion": (["goto", "stop"], "IN")}}
    with ScriptedSimulation(robots) as scripted:
        yield scripted


@pytest.fixture(autouse=True)
def _no_thread_stays_behind() -> Iterator[None]:
    yield
    wait_until(lambda: not client_threads())
