"""People ride in lifts: with the times of the lift, no more than it carries, and through no wall."""

import json
import re

import numpy as np
import pytest

import morse
from morse.core.state import StateError
from morse.plugins.people.riding import ABOARD, BOARDS, LEAVES, ON_FOOT, WAITS

SCENE = """
from morse.builder import *
lift = Lift("lift", levels=(0.0, 3.5), capacity=2, hold=2.0, speed=1.0, acceleration=0.8)
lift.rotate(z=3.14159265)
upper = Cube("upper")
upper.scale = (3.0, 3.0, 0.1)
upper.translate(-4.1, 0, 3.4)
upper.static()
people = Crowd("people", 3, floors=(0.0, 3.5), deviation=0.0)
people.start(places=[(-2.2, 0.0), (-2.8, 0.6), (-2.8, -0.6)])
people.goals([(-5, 0, 3.5)])
{more}
Environment("empty")
"""


@pytest.fixture
def load(tmp_path):
    def load(more="", **options):
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(more=more), "utf-8")
        return morse.load(path, **options)

    return load


def test_people_ride_to_their_floor_as_fast_as_the_lift_and_as_many_as_it_carries(load):
    """A ride takes way / v + v / a; people are as high as their floors or as the cabin, and nobody passes a wall."""
    with load() as sim:
        crowd, lift = sim.people.component, sim.lift.component
        begins, ends, most = None, None, 0
        for _ in range(30 * 60):
            sim.step()
            positions, riding = sim.people.data["positions"], crowd.riding
            inside = (np.abs(positions[:, 0]) < 1.0) & (np.abs(positions[:, 1]) < 0.9)
            moves = inside & (lift.local_data["openness"] == 0.0)
            most = max(most, int(moves.sum()))
            # a person is as high as the cabin was at most one tick before
            assert np.abs(positions[moves, 2] - lift.local_data["height"]).max(initial=0.0) <= 1.0 / 60 + 1e-9
            assert (np.isin(positions[~inside, 2], (0.0, 3.5))).all()
            on_foot = riding.area < 2
            gap, _ = crowd.ground.clearance(crowd.walkers.position[on_foot])
            assert (gap > 0.12).all()
            if begins is None and lift.local_data["speed"] > 0.0:
                assert moves.any()
                begins = crowd.clock.time
            if begins is not None and ends is None and lift.local_data["height"] == 3.5:
                ends = crowd.clock.time
            there = (positions[:, 0] < -2.5) & (positions[:, 2] == 3.5)
            if there.sum() == 2:
                break
        assert ends - begins == pytest.approx(3.5 / 1.0 + 1.0 / 0.8, abs=0.1)
        assert most == 2
        # the third one waits
        assert there.sum() == 2
        assert crowd.riding.ride[~there] == WAITS
        assert sim.failures == ()


def test_states_restore_people_in_a_lift_and_refuse_impossible_ones(load):
    with load(seed=3) as sim:
        riding = sim.people.component.riding
        for _ in range(40):
            sim.step(15)
            if (riding.area >= 2).any():
                break
        assert (riding.ride == ABOARD).any()
        state = sim.save()
        sim.step(120)
        after = sim.people.data["positions"].copy()
        sim.restore(state)
        sim.step(120)
        assert (sim.people.data["positions"] == after).all()
        own = sim.people.component.get_state()
        for name, value in (("area", 9), ("lift", 1), ("slot", 99), ("ride", BOARDS + LEAVES), ("area", 1)):
            broken = own | {"people": {**own["people"], name: np.full_like(own["people"][name], value)}}
            if name == "area" and value == 1:
                broken["people"]["lift"] = np.full(3, -1)
            with pytest.raises(Exception, match="nobody can be"):
                sim.people.component.set_state(broken)


def test_states_with_places_of_another_lift_are_refused(load):
    """A place of the large cabin is none in the small one, and only those who ride are in a cabin."""
    small = 'small = Lift("small", levels=(0.0, 3.5), size=(1.0, 0.9))\nsmall.translate(-8.0)\nsmall.rotate(z=3.1)'
    with load(small) as sim:
        crowd = sim.people.component
        own, places = crowd.get_state(), [len(one.slots) for one in crowd.floors.shafts]
        assert places[0] > places[1]
        for ride, lift, slot, area in (
            (BOARDS, 1, places[1], 0),
            (BOARDS, 0, places[0], 0),
            (ON_FOOT, -1, 0, 0),
            (WAITS, 0, -1, 2),
            (LEAVES, 1, -1, 3),
        ):
            values = {"ride": ride, "lift": lift, "slot": slot, "area": area}
            broken = {name: np.full_like(own["people"][name], value) for name, value in values.items()}
            with pytest.raises(StateError, match="nobody can be"):
                crowd.set_state(own | {"people": own["people"] | broken})
        sim.step(3)
        assert not sim.failures


def test_people_of_one_floor_do_not_see_those_of_another(load):
    """Two crowds that cross at different heights: nobody gives way."""
    more = """
above = Crowd("above", 1, deviation=0.0)
above.translate(z=3.5)
above.start(places=[(-20.0, 6.0)])
above.goals([(-12, 6)])
below = Crowd("below", 1, deviation=0.0)
below.start(places=[(-12.0, 6.0)])
below.goals([(-20, 6)])
"""
    with load(more) as sim:
        for _ in range(8):
            sim.step(30)
            for crowd in (sim.above, sim.below):
                assert crowd.data["positions"][0, 1] == pytest.approx(6.0, abs=0.01)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Crowd('c', 1, floors=(1.0, 2.0))", "the first is 0"),
        ("Crowd('c', 1, floors=range(0, 200, 5))", "1 to 20 heights"),
        ("Crowd('c', 1, floors=(0.0, 1.0))", "at least 2 m above each other"),
        ("Crowd('c', 1, floors=(0.0, float('nan')))", "Crowd(floors)"),
        ("Crowd('c', 1, floors=3)", "takes heights such as"),
        ("Crowd('c', 1).start([(0, 0), (1, 1, 3.5)])", "same height"),
        ("Lift(capacity=-1)", "Lift(capacity)"),
        ("people.goals([(0, 0, 1.7)])", "none of its floors, which are at 0, 3.5 m"),
        ("people.goals([(0, 0, 3.5)])\nlift.translate(z=1.0)", "nobody can reach"),
    ],
)
def test_mistakes_are_named(load, line, words):
    with pytest.raises(Exception, match=re.escape(words)), load(line) as sim:
        sim.step()


def test_properties_that_are_no_floors_are_refused(load):
    for floors in (json.dumps([0.0] * 30), json.dumps(["a"]), "[", "{}"):
        with (
            pytest.raises(Exception, match="Floors"),
            load(f"people.scene_node.properties.update(Floors={floors!r})") as sim,
        ):
            sim.step()


def test_services_refuse_floors_that_are_not_there(load):
    with load() as sim:
        for floor in (2, 99, 1 << 70):
            with pytest.raises(Exception, match="floor"):
                sim.people.send(0, -5.0, 0.0, floor).result()
        sim.people.send(0, -5.0, 0.0, 0).result()
        sim.step(5)
        assert sim.people.ask(0).result()["floor"] == 0
