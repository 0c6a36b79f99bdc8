"""People follow a robot, or the human of MORSE 1.4, around walls, one behind the other."""

import math

import numpy as np
import pytest

import morse
from morse.plugins.people.following import aims

SCENE = """
from morse.builder import *
wall = Cube("wall")
wall.scale = (0.1, 2.0, 1.0)
wall.translate(3.0, -1.0, 1.0)
wall.static()
human = Human()
human.translate(1.0, 0.0, 0.0)
motion = Waypoint()
human.append(motion)
people = Crowd("people", 3, deviation=0.0)
people.start(places=[(-0.4, 0.0), (-1.1, 0.3), (-1.1, -0.4)])
people.goals([(-1, 0)])
Environment("empty")
"""


@pytest.fixture
def sim(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(SCENE, "utf-8")
    with morse.load(path) as sim:
        yield sim


def test_the_aims_are_behind_the_leader_on_its_trail():
    """On a straight trail, the first follower goes to 1.1 m behind the leader, the next one to 0.65 m behind that."""
    trail = [(0.25 * k, 0.0) for k in range(41)]
    places = np.array([(8.5, 0.1), (8.2, -0.1), (3.0, 0.0), (0.0, 9.0)])
    found = aims(trail, (10.0, 0.0), places, np.arange(4))
    assert found[0, 0] == pytest.approx(8.9, abs=0.25)
    assert found[1, 0] == pytest.approx(8.25, abs=0.25)
    assert 3.0 < found[2, 0] <= 4.25
    assert np.isnan(found[3]).all()


def test_people_follow_the_human_around_a_wall_and_stop_behind_it(sim):
    assert sim.people.follow("human", 3).result() == [0, 1, 2]
    crowd = sim.people.component
    for x, y in ((2.0, 1.8), (4.5, 1.8), (4.5, -4.5)):
        sim.human.motion.publish({"x": x, "y": y, "z": 0.0, "tolerance": 0.2, "speed": 1.0})
        for _ in range(60):
            sim.step(10)
            here = sim.context.robots["human"].bge_object.world_pose()[0]
            assert (crowd.ground.clearance(crowd.walkers.position)[0] > 0.12).all()
            if math.dist(here[:2], (x, y)) < 0.3:
                break
    sim.step(200)
    state = sim.save()
    sim.step(40)
    after = sim.people.data["positions"].copy()
    sim.restore(state)
    sim.step(40)
    assert (sim.people.data["positions"] == after).all()
    here = sim.context.robots["human"].bge_object.world_pose()[0]
    apart = np.sort(np.hypot(*(after[:, :2] - here[:2]).T))
    assert (after[:, 0] > 3.2).all()
    # one behind the other on its trail
    assert apart == pytest.approx([1.1, 1.75, 2.4], abs=0.4)
    assert np.hypot(*sim.people.data["velocities"][:, :2].T).max() < 0.1
    sim.people.resume().result()
    sim.step(60)
    assert sim.people.ask(0).result()["state"] == "walks"


def test_leaders_whom_nobody_follows_any_more_are_forgotten(tmp_path):
    """People may follow more robots one after the other than at once."""
    path = tmp_path / "scene.py"
    robots = "".join(f"r{k} = FakeRobot()\nr{k}.translate({k % 6}, {k // 6 + 3})\n" for k in range(20))
    path.write_text(SCENE.replace('Environment("empty")', f'{robots}Environment("empty")'), "utf-8")
    with morse.load(path) as sim:
        crowd, followed = sim.people.component, {}
        for k in range(20):
            (person,) = sim.people.follow(f"r{k}", 1).result()
            followed[person] = f"r{k}"
        sim.people.send(person, 0.0, 0.0).result()
        del followed[person]
        (person,) = sim.people.follow("human", 1).result()
        followed[person] = "human"
        names = list(crowd._trails)
        assert {person: names[crowd.agenda.leader[person]] for person in followed} == followed
        assert len(names) <= 4
        sim.restore(sim.save())
        assert sim.people.ask(person).result()["state"] == "follows"


def test_what_is_no_leader_is_refused(sim):
    for name in ("nobody", "people", "x" * 5000, ""):
        with pytest.raises(Exception, match="there is no robot"):
            sim.people.follow(name, 1).result()
    own = sim.people.component.get_state()
    broken = [{"_trails": {"human": [(math.nan, 0.0)]}}, {"_trails": {"human": []}}, {"_trails": [1]}]
    broken.append({"people": {**own["people"], "leader": np.full(3, 2)}})
    for one in broken:
        with pytest.raises(Exception, match="nobody can be"):
            sim.people.component.set_state(own | one)


def test_people_see_a_robot_that_replaces_another_one_within_a_tick(sim):
    """The world has as many objects as before, but not the same ones."""
    sim.spawn("first", "ATRV", (5.0, 1.8, 0.1))
    sim.step(2)
    sim.delete("first")
    sim.spawn("second", "ATRV", (5.0, 1.8, 0.1))
    sim.step(2)
    assert not sim.failures


def test_a_crowd_knows_the_hall_in_which_it_is_and_no_more_of_the_world_than_its_cells_permit(load):
    """Its ground reaches to the outer walls: people can be led through a hall of 60 m, and not through a plain."""
    sim = load("""
        for side in (-1, 1):
            wall = Cube(f"wall {side}")
            wall.scale = (30.0, 0.1, 1.0)
            wall.translate(25.0, side * 4.0, 1.0)
            wall.static()
        far = Cube("far")
        far.translate(3000.0, 0.0, 1.0)
        far.static()
        people = Crowd("people", 1)
        people.start(places=[(0.0, 0.0)])
        Environment("empty")
    """)
    ground = sim.people.component.ground
    assert ground.cell == pytest.approx(0.1)
    assert ground.shape[0] * ground.shape[1] < 600_000
    sim.people.send(0, 50.0, 0.0).result()
    sim.step(60 * 50)
    assert math.dist(sim.people.data["positions"][0, :2], (50.0, 0.0)) < 1.0
