"""The human of MORSE 1.4 walks with a crowd, or is driven while the others give way, and leads others."""

import math

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError
from morse.core.state import StateError

SCENE = """
from morse.builder import *
human = Human()
human.translate(0.0, 0.0, 0.0)
motion = MotionVW()
human.append(motion)
people = Crowd("people", 2, deviation=0.0, model="{model}")
people.start(places=[(8.0, 0.05), (30.0, 0.0)], goals=[(0, 0)])
people.joins(human, {options})
{more}
Environment("empty")
"""

LIFT = """
from morse.builder import *
lift = Lift("lift", levels=(0.0, 3.5), hold=2.0)
lift.rotate(z=3.14159265)
upper = Cube("upper")
upper.scale = (3.0, 3.0, 0.1)
upper.translate(-4.1, 0, 3.4)
upper.static()
human = Human()
human.translate(-2.5, 0.0, 0.0)
people = Crowd("people", 2, floors=(0.0, 3.5), deviation=0.0)
people.start(places=[(-3.2, 0.5), (-3.6, -0.5)])
people.joins(human, goals=[(-5, 0, 3.5)])
Environment("empty")
"""


@pytest.fixture
def load(tmp_path):
    def load(options="goals=[(8, 0)]", more="", model="social-force"):
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(options=options, more=more, model=model), "utf-8")
        return morse.load(path)

    return load


def body(sim):
    return sim.context.robots["human"].bge_object.world_pose()


@pytest.mark.parametrize("model", ["social-force", "orca"])
def test_a_member_and_somebody_who_comes_towards_it_pass_without_touching(load, model):
    """Both give way, reach their goals, and walk at most a little faster than at the free speed of 1.34 m/s."""
    with load(model=model) as sim:
        before, closest, fastest = np.array(body(sim)[0][:2]), math.inf, 0.0
        aside = np.zeros(2)
        for _ in range(660):
            sim.step()
            here, other = np.array(body(sim)[0][:2]), sim.people.data["positions"][0, :2]
            closest = min(closest, math.dist(here, other))
            fastest = max(fastest, math.dist(here, before) * 60.0)
            aside = np.maximum(aside, np.abs([here[1], other[1] - 0.05]))
            before = here
        # bodies have a radius of 0.2 m
        assert closest > 0.4
        assert (aside > 0.03).all()
        assert fastest < 1.3 * 1.34
        assert math.dist(here, (8.0, 0.0)) < 0.5
        # the row of the member is where its body is, and its feet are on the ground
        assert np.abs(sim.people.data["positions"][2, :2] - here).max() < 0.03
        assert abs(body(sim)[0][2]) < 0.02
        assert not sim.failures


def test_a_member_walks_at_its_free_speed_and_looks_where_it_goes(load):
    with load("goals=[(0, 9)]") as sim:
        sim.step(180)
        begin = body(sim)[0]
        sim.step(120)
        end, turn = body(sim)
        assert math.dist(begin[:2], end[:2]) / 2.0 == pytest.approx(1.34, rel=0.02)
        assert math.atan2(turn[3], turn[0]) == pytest.approx(0.5 * math.pi, abs=0.1)
        assert sim.people.data["velocities"][2, 1] == pytest.approx(1.34, rel=0.02)


def test_commands_move_a_member_only_after_it_has_left_and_others_give_way_to_it(load):
    with load("goals=[(0, 0)]") as sim:
        sim.human.motion.publish({"v": 1.0, "w": 0.0})
        sim.step(60)
        assert math.dist(body(sim)[0][:2], (0.0, 0.0)) < 0.2
        sim.people.leave("human").result()
        sim.step(2)
        begin = body(sim)[0]
        closest = math.inf
        for _ in range(300):
            sim.step()
            closest = min(closest, math.dist(body(sim)[0][:2], sim.people.data["positions"][0, :2]))
        end = body(sim)[0]
        assert math.dist(begin[:2], end[:2]) == pytest.approx(5.0, rel=0.02)
        assert abs(end[1] - begin[1]) < 0.05
        assert closest > 0.35
        assert not sim.people.data["contacts"]
        assert not sim.people.data["present"][2]
        assert sim.people.ask(2).result()["state"] == "driven"
        assert sim.people.join("human").result() == 2
        sim.step(300)
        assert math.dist(body(sim)[0][:2], (0.0, 0.0)) < 1.0


def test_a_member_that_is_put_elsewhere_goes_on_from_there(load):
    """It is where its body is, and no jump counts as a velocity."""
    with load("goals=[(0, 9)]") as sim:
        sim.step(30)
        sim.context.world.objects_by_name["human"].worldPosition = (0.0, 3.0, 0.0)
        sim.step()
        assert np.abs(sim.people.data["positions"][2, :2] - (0.0, 3.0)).max() < 0.05
        assert np.abs(sim.people.data["velocities"][2]).max() < 1.0
        sim.step(60)
        assert body(sim)[0][1] > 3.5


def test_a_member_leads_those_who_follow_it(load):
    with load("goals=[(-9, 0)]") as sim:
        sim.people.stop(2).result()
        assert sim.people.follow("human", 5).result() == [0, 1]
        sim.step(60 * 6)
        sim.people.resume(2).result()
        sim.step(60 * 16)
        here = body(sim)[0]
        assert here[0] == pytest.approx(-9.0, abs=0.5)
        apart = math.dist(here[:2], sim.people.data["positions"][0, :2])
        assert apart == pytest.approx(1.1, abs=0.4)
        assert sim.people.ask(0).result()["state"] == "follows"


def test_states_restore_a_member_to_the_bit_and_refuse_impossible_ones(load):
    with load() as sim:
        sim.step(200)
        state = sim.save()
        sim.step(100)
        after, place = sim.people.data["positions"].copy(), body(sim)[0]
        sim.restore(state)
        sim.step(100)
        assert (sim.people.data["positions"] == after).all()
        assert tuple(body(sim)[0]) == tuple(place)
        crowd = sim.people.component
        own = crowd.get_state()
        broken = own["people"]["position"].copy()
        broken[2] = math.nan
        with pytest.raises(StateError):
            crowd.set_state(own | {"people": {**own["people"], "position": broken}})


def test_a_member_that_is_deleted_is_gone_for_the_others(load):
    with load() as sim:
        sim.step(30)
        sim.delete("human")
        sim.step(30)
        assert sim.people.data["present"].tolist() == [True, True, False]
        with pytest.raises(Exception, match="no member"):
            sim.people.join("human").result()
        assert not sim.failures


def test_what_is_no_member_is_refused(load):
    with load("joined=False") as sim:
        sim.step(2)
        assert not sim.people.data["present"][2]
        for name in ("nobody", "people", "x" * 5000, ""):
            with pytest.raises(Exception, match="no member"):
                sim.people.join(name).result()
        sim.context.world.objects_by_name["human"].worldPosition = (500.0, 0.0, 0.0)
        sim.step(2)
        with pytest.raises(Exception, match="where nobody can go"):
            sim.people.join("human").result()
    twice, unknown = "goals=[(1, 1)])\npeople.joins('human'", "goals=[(1, 1)])\npeople.joins('humen'"
    for options, words in ((twice, "joins twice"), (unknown, "there is no robot 'humen'.*human")):
        with pytest.raises(MorseError, match=words):
            load(options).close()
    with pytest.raises(MorseError, match="not a Human"):
        load("joined=False)\npeople.joins('atrv'", "atrv = ATRV()\natrv.translate(9, 9)").close()
    for line in ("people.joins(3)", "people.joins(human, goals=[])"):
        with pytest.raises(Exception, match=r"Crowd\.joins"):
            load(more=line).close()


def test_followers_ride_in_the_lift_with_their_leader(tmp_path):
    """The human goes to the upper floor; those who follow it ride in the same cabin, and follow it out."""
    path = tmp_path / "scene.py"
    path.write_text(LIFT, "utf-8")
    with morse.load(path) as sim:
        assert sim.people.follow("human", 2).result() == [0, 1]
        lift, together = sim.lift.component.local_data, False
        for _ in range(45 * 6):
            sim.step(10)
            places = sim.people.data["positions"]
            inside = (np.abs(places[:, 0]) < 1.0) & (np.abs(places[:, 1]) < 0.9)
            if lift["openness"] == 0.0 and 0.5 < lift["height"] < 3.0:
                assert inside.all()
                together = True
            if (places[:, 2] == 3.5).all() and not inside.any():
                break
        sim.step(120)
        places, here = sim.people.data["positions"], body(sim)[0]
        assert together
        assert here[2] == pytest.approx(3.5, abs=0.05)
        assert here[0] == pytest.approx(-5.0, abs=0.5)
        apart = np.sort(np.hypot(*(places[:2, :2] - here[:2]).T))
        assert apart == pytest.approx([1.1, 1.75], abs=0.5)
        assert [sim.people.ask(k).result()["state"] for k in (0, 1)] == ["follows", "follows"]
        assert not sim.failures


def test_a_leader_that_jumps_about_costs_one_search_for_a_way_in_half_a_second(load, monkeypatch):
    with load("joined=False", more="people.goals([(0, 3)])") as sim:
        sim.people.follow("human", 2).result()
        searches = []
        ground = type(sim.people.component.ground)
        search = ground.way_to
        monkeypatch.setattr(ground, "way_to", lambda *args: searches.append(1) or search(*args))
        for k in range(60):
            sim.context.world.objects_by_name["human"].worldPosition = (20.0 * (k % 2) + 0.05 * k, -5.0, 0.0)
            sim.step()
        assert 1 <= len(searches) <= 3
        # they still find it once it stands: 9 m away from one of them
        sim.step(60 * 9)
        apart = sim.people.data["positions"][:2, :2] - body(sim)[0][:2]
        assert np.hypot(*apart.T).min() < 2.0


@pytest.mark.parametrize("place", [(60.0, 0.0, 0.0), (1e7, -1e7, 0.0)], ids=["beside the ground", "far away"])
def test_a_member_that_is_carried_out_of_the_ground_leaves_the_crowd_which_goes_on(load, place):
    """It stays where it was put, the others walk on, also those who follow it, and their state can be restored."""
    with load() as sim:
        sim.step(5)
        sim.people.follow("human", 1).result()
        sim.context.robots["human"].bge_object.worldPosition = place
        before = sim.people.data["positions"][1].copy()
        sim.step(60)
        assert sim.people.component.active
        assert sim.people.ask(2).result()["state"] == "driven"
        assert body(sim)[0][:2] == pytest.approx(place[:2])
        assert np.hypot(*(sim.people.data["positions"][1] - before)[:2]) > 0.5
        sim.restore(sim.save())
        with pytest.raises(Exception, match="where nobody can go"):
            sim.people.join("human").result()
        sim.context.robots["human"].bge_object.worldPosition = (0.0, 0.0, 0.0)
        sim.step()
        assert sim.people.join("human").result() == 2


def test_a_member_that_is_put_into_a_wall_is_not_thrown_out_of_it(load):
    """The model of walking keeps people out of walls at once; a body that did so in a tick would move at 20 m/s."""
    wall = "wall = Cube('wall')\nwall.scale = (1.0, 3.0, 1.0)\nwall.translate(4.0, 6.0, 1.0)\nwall.static()"
    with load(more=wall) as sim:
        sim.step(5)
        human, speeds = sim.context.robots["human"], []
        human.guide = lambda linear, _: speeds.append(math.hypot(*linear))
        human.bge_object.worldPosition = (3.2, 6.0, 0.0)
        sim.step(5)
        assert 0.1 < max(speeds) <= 5.0 + 1e-9


@pytest.mark.parametrize("place", [(9e5, 0.0), (-9e5, 0.0), (0.0, 9e5)])
def test_states_with_people_outside_of_the_ground_are_refused(load, place):
    with load() as sim:
        state = sim.people.component.get_state()
        state["people"]["position"][0] = place
        with pytest.raises(StateError, match="nobody can be"):
            sim.people.component.set_state(state)
