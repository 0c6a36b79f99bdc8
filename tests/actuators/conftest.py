import pytest


@pytest.fixture
def simulation(loaded):
    """The simulation that the tests of the module share, restarted."""
    loaded.restart()
    loaded.step()
    return loaded


def component(simulation, name):
    return simulation.context.component(name)
