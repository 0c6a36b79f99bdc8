from __future__ import annotations

import pytest

import morse


@pytest.fixture
def run(tmp_path):
    """Loads scene scripts, without network and wall clock; an environment is appended if the script has none."""
    made = []

    def load(script, environment="env = Environment('empty')"):
        path = tmp_path / f"scene{len(made)}.py"
        path.write_text(f"from morse.builder import *\n{script}\n{environment}\n")
        made.append(morse.load(path))
        return made[-1]

    yield load
    for simulation in made:
        simulation.close()


@pytest.fixture(scope="module")
def loaded(request, tmp_path_factory):
    """The simulation of the scene script ``SCENE`` of the module."""
    path = tmp_path_factory.mktemp("shared") / "scene.py"
    path.write_text(request.module.SCENE)
    with morse.load(path) as simulation:
        yield simulation


@pytest.fixture
def simulation(loaded):
    """The simulation that the tests of the module share, restarted."""
    loaded.restart()
    loaded.step()
    return loaded


def component(simulation, name):
    return simulation.context.component(name)
