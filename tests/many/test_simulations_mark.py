"""The mark of tests that run with many seeds."""

import subprocess
import sys

TEST = """
import pytest

def scene():
    from morse.builder import ATRV, Environment, GPS
    robot = ATRV("robot")
    gps = GPS("gps")
    gps.noise(gaussian=1.0)
    robot.append(gps)
    Environment("empty")

@pytest.mark.simulations(seeds=20, at_least=0.5)
def test_mostly(simulation, seed, tmp_path):
    assert simulation.seed() == seed
    simulation.step(1)
    assert abs(simulation.robot.gps.data["x"]) < 2.5

@pytest.mark.simulations(scene, seeds=[3, 4, 5], at_least=0.9)
def test_never(simulation):
    simulation.step(1)
    assert simulation.seed() == 4, "not four"

def test_plain(tmp_path):
    assert tmp_path.is_dir()
"""


def test_a_share_of_the_seeds_has_to_pass(tmp_path):
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["morse.testing.simulations"]\n')
    (tmp_path / "test_it.py").write_text(TEST)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "--strict-markers", "test_it.py"]
    outcome = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=240)
    assert "1 failed, 2 passed" in outcome.stdout, outcome.stdout
    assert "passed with 1 of 3 seeds, at least 90% are required" in outcome.stdout
    assert "seed 3: AssertionError: not four" in outcome.stdout
    for seed in (3, 5):
        assert (tmp_path / "failed_simulations" / "test_never" / f"seed{seed}.mcap").stat().st_size > 0
