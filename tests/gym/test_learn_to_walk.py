"""The example that learns to walk: the weights that ship, a short search, and at night the whole of it."""

import importlib.util
import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def example():
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


def test_the_weights_that_ship_walk_over_ground_they_have_not_seen(example):
    weights = np.array(json.loads(example.WEIGHTS.read_text()))
    way, up = example.judge(weights, layouts=range(2000, 2006), seed=77)
    assert up.all()
    # in six seconds
    assert way.mean() > 3.0
    assert way.min() > 1.5


def test_without_weights_it_stands(example):
    way, up = example.judge(np.zeros((example.OUTPUTS, example.INPUTS)), layouts=range(2000, 2002))
    assert up.all()
    assert np.abs(way).max() < 0.2


def test_the_legs_of_both_sides_do_the_same_in_the_mirror(example):
    rng = np.random.default_rng(5)
    weights, seen = rng.standard_normal((example.OUTPUTS, example.INPUTS)), rng.standard_normal((3, 8))
    chosen, mirrored = example.actions(weights, seen), example.actions(weights, seen * example.MIRROR)
    assert chosen[:, 0::2] == pytest.approx(mirrored[:, 1::2])


def test_a_short_search(example, monkeypatch):
    monkeypatch.setattr(example, "ROWS", 4)
    monkeypatch.setattr(example, "WORKERS", 0)
    monkeypatch.setattr(example, "LENGTH", 5)
    weights, curve = example.train(rounds=2, tell=print)
    assert [row[0] for row in curve] == [20, 40]
    assert np.abs(weights).max() > 0.0
    ElementTree.fromstring(example.learn_to_drive.picture(curve, 0.5))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_it_learns_to_walk(example, tmp_path):
    way, up = example.main(["--learn", "--weights", str(tmp_path / "weights.json")])
    assert way.mean() > 2.5
    assert up.mean() >= 0.8
