"""The planted faults of the benchmark of falsification: each is there, and only where the benchmark says."""

import pytest

import morse
from benchmarks.programs.falsify import scenario_of
from benchmarks.programs.planted import FAULTS, scene

pytestmark = pytest.mark.long

#: cases in which the controllers fail, as the benchmark has found them
CASES = {
    "unwrapped": {"x": 0.007},
    "half_plane": {"x": 0.39},
    "dead_band": {"yaw": -3.1415},
    "degrees": {"declination": -0.9},
    "circling": {"x": 0.5, "y": 1.0, "speed": 1.12, "yaw": -0.2},
    "ambiguous": {"ahead": 5.01},
    "linear_brake": {"speed": 1.9921116314557974, "grip": 0.5},
    "byte": {"speed": 2.0, "ahead": 8.0, "grip": 0.4},
    "frame": {"x": 2.0, "y": -0.33, "yaw": 0.97},
    "counter": {"pause": 10.0, "speed": 0.99},
    "late_gain": {"y": 0.98, "speed": 0.99, "latency": 0.551, "gain": 1.5},
    "windup": {"y": 0.79, "slip": 2.51, "gain": 0.89},
    "slow_reader": {"x": 1.55, "y": -0.1, "walk": 0.85},
}


@pytest.fixture(scope="module")
def sim():
    with morse.load(scene) as simulation:
        yield simulation


def test_there_are_twenty():
    assert len(FAULTS) == 20
    assert all(scenario_of(name).space.free for name in FAULTS)


@pytest.mark.parametrize("name", list(FAULTS))
def test_the_defaults_hide_it(sim, name):
    for mended in (False, True):
        sim.restart(0)
        assert FAULTS[name].run(sim, mended=mended) > FAULTS[name].limit


@pytest.mark.parametrize("name", list(CASES))
def test_the_fault_is_the_reason(sim, name):
    sim.restart(0)
    assert FAULTS[name].run(sim, **CASES[name]) <= FAULTS[name].limit
    sim.restart(0)
    assert FAULTS[name].run(sim, mended=True, **CASES[name]) > FAULTS[name].limit
