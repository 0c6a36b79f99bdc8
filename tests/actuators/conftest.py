import pytest

import morse


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
