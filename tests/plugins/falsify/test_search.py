"""What the choice of points finds, how cases become plain, and parameters as places from 0 to 1."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.many import choice, loguniform, normal, uniform
from morse.plugins.falsify.search import SEARCHES, Archive
from morse.plugins.falsify.shrinking import Shrinking
from morse.plugins.falsify.space import Axis, Space, halton

SPACE = Space({"a": uniform(-1.0, 3.0), "b": loguniform(0.1, 10.0), "c": range(100), "d": uniform(0.0, 1.0)}, {})


def far_from_needle(point):
    """Negative in one of 30,000 cases, and a slope towards it everywhere."""
    place = SPACE.places(point)
    return float(np.linalg.norm(place - np.array([0.81, 0.23, 0.345, 0.9]))) - 0.05


def runs_until_found(name, seed, most):
    pytest.importorskip({"cma": "cma", "optuna": "optuna"}.get(name, "numpy"))
    archive = Archive(len(SPACE.free), 1)
    search = SEARCHES[name](SPACE, archive, np.random.default_rng(seed))
    for number in range(most):
        place = search.propose(0)
        assert ((place >= 0.0) & (place <= 1.0)).all()
        robustness = far_from_needle(SPACE.point(place))
        if robustness < 0.0:
            return number
        archive.add(place, [robustness])
        search.tell(place, [robustness])
    return most


@pytest.mark.parametrize(("name", "most"), [("guided", 700), ("cma", 700), ("optuna", 250)])
def test_it_follows_the_slope(name, most):
    seeds = range(5) if name != "optuna" else range(2)
    assert all(runs_until_found(name, seed, most) < most for seed in seeds)


@pytest.mark.parametrize("name", ["random", "halton"])
def test_without_a_slope_it_is_luck(name):
    assert sum(runs_until_found(name, seed, 700) < 700 for seed in range(5)) <= 2


@pytest.mark.parametrize("name", list(SEARCHES))
def test_values_that_are_no_numbers_disturb_no_search(name):
    pytest.importorskip({"cma": "cma", "optuna": "optuna"}.get(name, "numpy"))
    archive = Archive(len(SPACE.free), 2)
    search = SEARCHES[name](SPACE, archive, np.random.default_rng(3))
    for number in range(60):
        place = search.propose(number % 2)
        robustness = [math.nan, -1e9] if number % 3 else [math.nan, math.nan]
        archive.add(place, robustness)
        search.tell(place, robustness)
    assert archive.count == 60


@pytest.mark.parametrize("name", ["guided", "cma", "optuna"])
def test_errors_that_are_known_do_not_attract_the_search(name):
    """A quarter of the space ends by an error, which says nothing of the requirement: it is sought in the rest."""
    pytest.importorskip({"cma": "cma", "optuna": "optuna"}.get(name, "numpy"))
    archive = Archive(len(SPACE.free), 1)
    search = SEARCHES[name](SPACE, archive, np.random.default_rng(3))
    errors = 0
    for _ in range(200):
        place = search.propose(0)
        is_error = place[0] > 0.75
        errors += is_error
        robustness = -1e9 if is_error else 1.0 + float(np.abs(place - 0.3).max())
        archive.add(place, [robustness])
        search.tell(place, [robustness])
    assert errors < 60


def shrunk(fails, found, space=SPACE):
    shrinking = Shrinking(space, found)
    steps, answer, count = shrinking.steps(), None, 0
    while True:
        try:
            point = next(steps) if answer is None else steps.send(answer)
        except StopIteration:
            return shrinking, count
        answer, count = fails(point), count + 1
        assert count < 400


def test_what_does_not_matter_is_the_default_and_the_rest_is_at_the_boundary():
    shrinking, count = shrunk(
        lambda point: point["a"] > 2.0 and point["c"] >= 37, {"a": 2.9, "b": 7.0, "c": 93, "d": 0.1}
    )
    smallest = shrinking.smallest
    assert (smallest["b"], smallest["d"]) == (pytest.approx(1.0), 0.5)
    assert smallest["c"] == 37
    assert 2.0 < smallest["a"] <= 2.03
    assert set(shrinking.boundaries) == {"a", "c"}
    assert shrinking.boundaries["a"].passes <= 2.0 < shrinking.boundaries["a"].fails
    assert shrinking.boundaries["c"].passes == 36
    assert count < 60


@given(st.floats(0.05, 0.95), st.floats(0.0, 1.0), st.sampled_from([-1.0, 1.0]))
def test_the_smallest_case_fails_whatever_fails(where, depth, side):
    space = Space({"a": uniform(-1.0, 1.0)}, {"a": 0.0})
    found = {"a": side * (where + (1.0 - where) * depth)}
    shrinking, _ = shrunk(lambda point: point["a"] * side >= where, found, space)
    assert where <= shrinking.smallest["a"] * side <= min(abs(found["a"]), where + 0.05) + 0.06


def test_a_seed_is_replaced_by_a_small_one_if_that_fails_too():
    space = Space({"seed": range(1000)}, {})
    assert shrunk(lambda point: point["seed"] % 7 == 3, {"seed": 878}, space)[0].smallest == {"seed": 3}
    assert shrunk(lambda point: point["seed"] == 878, {"seed": 878}, space)[0].smallest == {"seed": 878}


@pytest.mark.parametrize(
    "given_values",
    [uniform(2.0, 5.0), loguniform(0.01, 100.0), normal(3.0, 0.5), range(3, 40, 4), [1, 2, 5], choice("x", "y", "z")],
)
def test_places_and_values_are_one_to_one(given_values):
    axis = Axis("p", given_values)
    for place in (0.0, 0.2, 0.5, 0.77, 1.0):
        value = axis.value(place)
        assert axis.value(axis.place(value)) == pytest.approx(value) if not isinstance(value, str) else value
    assert 0.0 <= axis.place(axis.default) <= 1.0


def test_defaults():
    assert Axis("p", uniform(2.0, 5.0)).default == 3.5
    assert Axis("p", loguniform(0.1, 10.0)).default == pytest.approx(1.0)
    assert Axis("p", normal(3.0, 0.5)).default == 3.0
    assert Axis("p", choice(40, 0)).default == 40
    assert Axis("p", uniform(2.0, 5.0), 4.0).default == 4.0
    assert Axis("p", uniform(2.0, 2.0)).is_constant


@pytest.mark.parametrize(
    ("values", "default", "message"),
    [
        (range(0), ..., "the parameter 'p' has no values"),
        ([], ..., "the parameter 'p' has no values"),
        (uniform(0.0, 1.0), 3.0, "the default 3.0 of 'p' is not from 0 to 1"),
        (uniform(0.0, 1.0), "fast", "the default 'fast' of 'p' is not from 0 to 1"),
        ([1, 2], 3, "the default 3 of 'p' is none of its values"),
    ],
)
def test_an_axis_without_sense_is_refused(values, default, message):
    with pytest.raises(ValueError, match=message):
        Axis("p", values, default)


def test_halton_leaves_no_great_gaps():
    points = np.array([halton(number, 2) for number in range(64)])
    cells = {tuple(cell) for cell in (points * 6).astype(int)}
    assert len(cells) >= 30
    assert ((points >= 0) & (points < 1)).all()


def test_the_command_names_all_searches():
    from morse.plugins.falsify import command
    from morse.plugins.falsify.search import SEARCHES

    named = command._SEARCHES.partition(": ")[2].rstrip(".").split(", ")
    assert set(named) == {"auto", *SEARCHES}
