"""The examples that learn: gradients, mirrors, short runs, and at night the whole of it."""

import importlib.util
import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import morse
import morse.gym

ROOT = Path(__file__).parents[2]


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def example():
    return loaded("learn_to_drive")


def test_gradients_are_those_of_differences(example):
    rng = np.random.default_rng(3)
    network = example.Network(rng, [5, 4, 3], 1.0)
    values, wanted = rng.standard_normal((6, 5)), rng.standard_normal((6, 3))

    def loss():
        return float(0.5 * ((network(values) - wanted) ** 2).sum())

    slopes = []
    network.means = [np.zeros_like(weight) for weight in network.weights]
    before = [weight.copy() for weight in network.weights]
    for weight in network.weights:
        slope = np.zeros_like(weight)
        for place in np.ndindex(weight.shape):
            weight[place] += 1e-6
            above = loss()
            weight[place] -= 2e-6
            slope[place] = (above - loss()) / 2e-6
            weight[place] += 1e-6
        slopes.append(slope)
    network.learn(network(values) - wanted, 0.0)
    size = np.sqrt(sum((slope**2).sum() for slope in slopes))
    for mean, slope, weight, first in zip(network.means, slopes, network.weights, before, strict=True):
        assert mean == pytest.approx(0.1 * slope * min(1.0, 0.5 / size), abs=1e-6)
        assert weight == pytest.approx(first)


def test_the_mirror_of_the_mirror_is_the_arena(example):
    rng = np.random.default_rng(4)
    seen, actions = rng.standard_normal((7, 40)), rng.standard_normal((7, 2))
    again = example.mirrored(*example.mirrored(seen, actions))
    assert (again[0] == seen).all()
    assert (again[1] == actions).all()


def test_a_short_run(example):
    driver, curve = example.train(2 * example.ROWS * example.LENGTH, tell=print)
    assert [row[0] for row in curve] == [2048, 4096]
    assert driver.policy.updates == 2 * example.PASSES * example.PARTS
    ElementTree.fromstring(example.picture(curve, 0.5))


def test_a_short_run_of_three_robots(example, monkeypatch):
    monkeypatch.setitem(sys.modules, "learn_to_drive", example)
    crossing = loaded("learn_to_cross")
    team, curve = crossing.train(2 * 6 * crossing.LENGTH, tell=print, worlds=2)
    assert [row[0] for row in curve] == [192, 384]
    assert team.policy.updates == 2 * example.PASSES * example.PARTS


@pytest.mark.slow
def test_three_robots_learn_not_to_meet(example, monkeypatch):
    monkeypatch.setitem(sys.modules, "learn_to_drive", example)
    assert loaded("learn_to_cross").main([]) >= 0.9


@pytest.mark.slow
def test_it_learns_to_drive_in_new_arenas(example):
    assert example.main([]) >= 0.85


# -- the example that learns to walk: the weights that ship, a short search, and at night the whole of it

FOLDER = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def learn_to_walk_example():
    sys.path.insert(0, str(FOLDER))
    try:
        spec = importlib.util.spec_from_file_location("learn_to_walk", FOLDER / "learn_to_walk.py")
        module = sys.modules["learn_to_walk"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        yield module
    finally:
        sys.path.remove(str(FOLDER))
        for name in ("learn_to_walk", "learn_to_drive"):
            sys.modules.pop(name, None)


def test_the_weights_that_ship_walk_over_ground_they_have_not_seen(learn_to_walk_example):
    weights = np.array(json.loads(learn_to_walk_example.WEIGHTS.read_text()))
    way, up = learn_to_walk_example.judge(weights, layouts=range(2000, 2006), seed=77)
    assert up.all()
    # in six seconds
    assert way.mean() > 3.0
    assert way.min() > 1.5


def test_without_weights_it_stands(learn_to_walk_example):
    way, up = learn_to_walk_example.judge(
        np.zeros((learn_to_walk_example.OUTPUTS, learn_to_walk_example.INPUTS)), layouts=range(2000, 2002)
    )
    assert up.all()
    assert np.abs(way).max() < 0.2


def test_the_legs_of_both_sides_do_the_same_in_the_mirror(learn_to_walk_example):
    rng = np.random.default_rng(5)
    weights, seen = (
        rng.standard_normal((learn_to_walk_example.OUTPUTS, learn_to_walk_example.INPUTS)),
        rng.standard_normal((3, 8)),
    )
    chosen, mirrored = (
        learn_to_walk_example.actions(weights, seen),
        learn_to_walk_example.actions(weights, seen * learn_to_walk_example.MIRROR),
    )
    assert chosen[:, 0::2] == pytest.approx(mirrored[:, 1::2])


def test_a_short_search(learn_to_walk_example, monkeypatch):
    monkeypatch.setattr(learn_to_walk_example, "ROWS", 4)
    monkeypatch.setattr(learn_to_walk_example, "WORKERS", 0)
    monkeypatch.setattr(learn_to_walk_example, "LENGTH", 5)
    weights, curve = learn_to_walk_example.train(rounds=2, tell=print)
    assert [row[0] for row in curve] == [20, 40]
    assert np.abs(weights).max() > 0.0
    ElementTree.fromstring(learn_to_walk_example.learn_to_drive.picture(curve, 0.5))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_it_learns_to_walk(learn_to_walk_example, tmp_path):
    way, up = learn_to_walk_example.main(["--learn", "--weights", str(tmp_path / "weights.json")])
    assert way.mean() > 2.5
    assert up.mean() >= 0.8


# -- the example that learns to trot: the same for the ant of Gymnasium


@pytest.fixture(scope="module")
def learn_to_trot_example(learn_to_walk_example):
    example = loaded("learn_to_trot")
    if not example.ANT.exists():
        pytest.skip("this Gymnasium has no ant")
    return example


def test_the_ant_trots_with_the_weights_that_ship(learn_to_trot_example):
    weights = np.array(json.loads(learn_to_trot_example.WEIGHTS.read_text()))
    way, up = learn_to_trot_example.judge(weights, rows=6, seed=77)
    assert up.all()
    # in six seconds
    assert way.mean() > 8.0
    assert way.min() > 5.0


def test_without_weights_the_ant_stands(learn_to_trot_example):
    way, up = learn_to_trot_example.judge(np.zeros((4, 11)), rows=2)
    assert up.all()
    assert np.abs(way).max() < 0.2


def test_the_diagonals_do_the_same_in_the_mirror(learn_to_trot_example, learn_to_walk_example):
    rng = np.random.default_rng(5)
    weights, seen = rng.standard_normal((4, 11)), rng.standard_normal((3, 8))
    chosen = learn_to_trot_example.actions(weights, seen)
    mirrored = learn_to_trot_example.actions(weights, seen * learn_to_walk_example.MIRROR)
    # left and right are exchanged; hips then turn the other way
    assert mirrored == pytest.approx(chosen[:, [1, 0, 3, 2, 5, 4, 7, 6]] * [-1, -1, -1, -1, 1, 1, 1, 1])


def test_the_rows_of_the_ant_go_on_together(learn_to_trot_example):
    """Without this, learning takes twice as long."""
    envs, steps, run = morse.gym.vector(learn_to_trot_example.Trot, 4), [], morse.Simulation.step
    envs.reset(seed=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(morse.Simulation, "step", lambda self, *a, **k: steps.append(self) or run(self, *a, **k))
        for _ in range(3):
            envs.step(np.full((4, 8), 0.0, np.float32))
    envs.close()
    # the reset has placed the robots, after which each simulation takes a step of its own
    assert len(steps) == 4


def test_a_short_search_for_a_trot(learn_to_trot_example, learn_to_walk_example, monkeypatch):
    monkeypatch.setattr(learn_to_walk_example, "ROWS", 4)
    monkeypatch.setattr(learn_to_walk_example, "WORKERS", 0)
    monkeypatch.setattr(learn_to_trot_example, "LENGTH", 5)
    weights, curve = learn_to_trot_example.train(rounds=2, tell=print)
    assert [row[0] for row in curve] == [20, 40]
    assert np.abs(weights).max() > 0.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_it_learns_to_trot(learn_to_trot_example, tmp_path):
    way, up = learn_to_trot_example.main(["--learn", "--weights", str(tmp_path / "weights.json")])
    assert way.mean() > 8.0
    assert up.mean() >= 0.9


@pytest.mark.slow
def test_stable_baselines_learns_with_it(learn_to_trot_example):
    pytest.importorskip("stable_baselines3", reason="it is installed in the nightly run: pip install stable-baselines3")
    from stable_baselines3 import PPO

    envs = morse.gym.baselines(learn_to_trot_example.Trot, 8)
    model = PPO("MlpPolicy", envs, n_steps=32, batch_size=64, seed=0, device="cpu")
    model.learn(512)
    action, _ = model.predict(envs.reset(), deterministic=True)
    assert envs.action_space.contains(action[0])
    envs.close()


# -- the example of an arm that learns to reach


@pytest.fixture(scope="module")
def learn_to_reach_example(learn_to_walk_example):
    return loaded("learn_to_reach")


def test_the_arm_reaches_with_the_weights_that_ship(learn_to_reach_example):
    weights = np.array(json.loads(learn_to_reach_example.WEIGHTS.read_text()))
    assert learn_to_reach_example.judge(weights, rows=12, seed=77) >= 0.6
    assert learn_to_reach_example.judge(np.zeros((3, 16)), rows=4) == 0.0


def test_a_short_search_for_the_way_to_a_place(learn_to_reach_example, learn_to_walk_example, monkeypatch):
    monkeypatch.setattr(learn_to_walk_example, "ROWS", 4)
    monkeypatch.setattr(learn_to_walk_example, "WORKERS", 0)
    monkeypatch.setattr(learn_to_reach_example, "LENGTH", 5)
    weights, curve = learn_to_reach_example.train(rounds=2, tell=print)
    assert [row[0] for row in curve] == [20, 40]
    assert np.abs(weights).max() > 0.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_it_learns_to_reach(learn_to_reach_example, tmp_path):
    assert learn_to_reach_example.main(["--learn", "--weights", str(tmp_path / "weights.json")]) >= 0.6


# -- the example of an arm that learns to pick up a box


@pytest.fixture(scope="module")
def learn_to_pick_example(learn_to_reach_example):
    return loaded("learn_to_pick")


def test_the_arm_picks_with_the_weights_that_ship(learn_to_pick_example):
    weights = np.array(json.loads(learn_to_pick_example.WEIGHTS.read_text()))
    assert learn_to_pick_example.judge(weights, rows=12, seed=77) >= 0.6
    # the hand reaches the box without the four weights that are learned first here, but does not close
    weights[0, 48:] = 0.0
    assert learn_to_pick_example.judge(weights, rows=4, seed=77) == 0.0


def test_a_short_search_for_a_grasp(learn_to_pick_example, learn_to_walk_example, monkeypatch):
    monkeypatch.setattr(learn_to_walk_example, "ROWS", 4)
    monkeypatch.setattr(learn_to_walk_example, "WORKERS", 0)
    monkeypatch.setattr(learn_to_pick_example, "LENGTH", 5)
    weights, curve = learn_to_pick_example.train(rounds=2, tell=print)
    assert [row[0] for row in curve] == [20, 40]
    assert np.abs(weights[0, 48:]).max() > 0.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_it_learns_to_pick(learn_to_pick_example, tmp_path):
    assert learn_to_pick_example.main(["--learn", "--weights", str(tmp_path / "weights.json")]) >= 0.6
