"""People and things that move: nobody begins in a thing, and no thing is pushed harder than by what has approached."""

import numpy as np
import pytest

import morse
from morse.plugins.people.contacts import GIVES_WAY
from morse.plugins.people.wayfinding import distance_to

SCENE = """
from morse.builder import *
{lines}
crate = Cube("crate")
crate.scale = (0.5, 0.5, 0.5)
crate.translate(0, 6, 0.51)
crate.set_rigid_body()
crate.set_mass(40.0)
robot = ATRV("robot")
robot.translate(-6, 0, 0.2)
Environment("empty")
"""
AROUND = [(2, -0.1), (2.3, 0.6), (2, -1), (2.9, 0), (2, 1.3), (2.5, -0.6)]


@pytest.fixture
def load(tmp_path):
    def load(lines, **options):
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(lines=lines), "utf-8")
        return morse.load(path, **options)

    return load


def _depth(sim, crowd):
    """How deep the deepest person stands in something that moves, m."""
    walkers = crowd.component.walkers
    here, radius = walkers.position[walkers.present], walkers.radius[walkers.present]
    outlines = crowd.component._around.outlines()
    return max([0.0, *((radius - distance_to(one, here)).max() for one in outlines if len(here))])


@pytest.mark.parametrize("seed", range(3))
def test_nobody_begins_in_a_crate_of_the_world(tmp_path, seed):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
robot = ATRV("robot")
robot.translate(z=0.2)
crowd = Crowd("people", 20)
crowd.start([(-1, -3), (4, 3)])
Environment("outdoors")
""",
        "utf-8",
    )
    with morse.load(path, seed=seed) as sim:
        assert sim.people.data["present"].sum() > 10
        assert _depth(sim, sim.people) == 0.0
        robot = sim.context.world.objects_by_name["robot"]
        for _ in range(60):
            sim.step()
            assert max([0.0, *(one["force"] for one in sim.people.data["contacts"])]) < 300.0
        assert robot.world_pose()[1][8] > 0.95


def test_who_has_no_place_beside_a_thing_a_robot_or_another_crowd_is_left_out(load):
    lines = """
first = Crowd("first", 2)
first.start(places=[(4, 0), (5, 0)])
second = Crowd("second", 5)
second.start(places=[(4.1, 0), (5.5, 0), (0.2, 6), (-6, 0.1), (8, 8)])
third = Crowd("third", 8)
third.start([(-1.2, 4.8), (1.2, 7.2)])
"""
    with load(lines) as sim:
        assert sim.first.data["present"].all()
        assert sim.second.data["present"].tolist() == [False, True, False, False, True]
        assert 0 < sim.third.data["present"].sum() <= 8
        assert _depth(sim, sim.third) == 0.0
        sim.step(30)
        assert sim.second.data["contacts"] == []


def test_a_person_beside_a_wheelchair_does_not_overlap_it(load):
    with load('c = Crowd("people", 30, wheelchairs=0.5)\nc.start([(0, -3), (4, 3)])') as sim:
        walkers = sim.people.component.walkers
        here = walkers.position[walkers.present]
        radius = walkers.radius[walkers.present]
        apart = np.linalg.norm(here[:, None] - here[None], axis=2) + 9.0 * np.eye(len(here))
        assert (apart >= radius[:, None] + radius[None]).all()


def test_nobody_enters_where_something_stands_now(load):
    with load('c = Crowd("people", 6)\nc.start([(8, -0.45), (8.9, 0.45)], over=1.0)') as sim:
        crate = sim.context.world.objects_by_name["crate"]
        crate.worldPosition = (8.45, 0.0, 0.5)
        sim.step(120)
        assert not sim.people.data["present"].any()
        crate.worldPosition = (0.0, 6.0, 0.5)
        sim.step(120)
        assert sim.people.data["present"].any()


@pytest.mark.parametrize(("name", "height"), [("crate", 0.51), ("robot", 0.2), ("crate", 3.0)])
def test_what_is_put_onto_people_is_not_pushed_and_they_leave_it(load, name, height):
    with load(f'c = Crowd("people", 6, deviation=0.0)\nc.start(places={AROUND})') as sim:
        sim.step(3)
        body = sim.context.world.objects_by_name[name]
        body.worldPosition = (2.1, 0.0, height)
        sim.step(150)
        assert _depth(sim, sim.people) < 0.02
        x, y, _ = body.world_pose()[0]
        assert (x, y) == pytest.approx((2.1, 0.0), abs=0.05)
        assert sim.people.data["exceeded"] == 0
        assert np.linalg.norm(sim.people.data["velocities"], axis=1).max() < 0.3


@pytest.mark.parametrize("speed", [6.0, 12.0, 40.0])
def test_a_crate_that_is_thrown_at_people_is_stopped_by_limited_forces(load, speed):
    with load(f'c = Crowd("people", 6, deviation=0.0)\nc.start(places={AROUND})') as sim:
        crate = sim.context.world.objects_by_name["crate"]
        crate.worldPosition = (0.5, 0.0, 0.9)
        crate.set_velocity((speed, 0.0, 0.0), None)
        touched = 0
        for _ in range(90):
            sim.step()
            forces = [one["force"] for one in sim.people.data["contacts"]]
            touched += len(forces)
            assert max([0.0, *forces]) <= GIVES_WAY
            velocity = crate.velocity()[0]
            assert np.hypot(*velocity[:2]) < 1.1 * speed
        assert touched
        assert sim.people.data["exceeded"] > 0


def test_who_is_pressed_against_a_wall_is_pressed_with_limited_force(load):
    lines = """
wall = Cube("wall")
wall.scale = (0.2, 3, 1.5)
wall.translate(3.0, 0, 1.5)
wall.static()
crowd = Crowd("people", 1, deviation=0.0)
crowd.start(places=[(2.4, 0.0)])
"""
    with load(lines) as sim:
        crate = sim.context.world.objects_by_name["crate"]
        crate.worldPosition = (1.2, 0.0, 0.5)
        for _ in range(120):
            crate.set_velocity((1.0, 0.0, 0.0), None)
            sim.step()
            assert max([0.0, *(one["force"] for one in sim.people.data["contacts"])]) <= GIVES_WAY
            assert sim.people.data["positions"][0, 0] < 2.8


@pytest.mark.parametrize("locked", [False, True])
def test_people_open_the_doors_to_which_they_walk(load, locked):
    lines = """
for number, y in enumerate((2.5, -2.5)):
    wall = Cube(f"wall{number}")
    wall.scale = (0.1, 2.0, 1.2)
    wall.translate(14, y, 1.2)
    wall.static()
door = Door("door")
door.translate(x=14.0)
people = Crowd("people", 4)
people.start([(10, -1.5), (12, 1.5)])
people.goals([(17, 0)])
"""
    with load(lines) as sim:
        if locked:
            sim.door.lock().result()
        sim.step(5)
        assert sim.door.data["openness"] < 0.1
        for _ in range(20):
            sim.step(60)
            if (sim.people.data["positions"][:, 0] > 15.0).all():
                break
        through = sim.people.data["positions"][:, 0] > 14.2
        assert through.all() != locked
        assert through.any() != locked
        assert (sim.door.data["openness"] == 0.0) == locked
        assert sim.failures == ()


def test_wheelchairs_stay_out_of_walls(load):
    """Through a door of 1 m and along walls, nobody is nearer to a wall than 0.9 of the own radius allows."""
    walls = "".join(
        f'w{i} = Cube("wall{i}")\nw{i}.scale = ({sx}, {sy}, 1.5)\nw{i}.translate({x}, {y}, 1.5)\nw{i}.static()\n'
        for i, (x, y, sx, sy) in enumerate(
            ((10, 22, 6, 0.1), (10, 18, 6, 0.1), (10, 21.3, 0.1, 0.8), (10, 18.7, 0.1, 0.8))
        )
    )
    crowd = (
        'c = Crowd("people", 12, wheelchairs=0.5)\nc.start([(5, 18.6), (9, 21.4)])\nc.goals([(15, 20)], then="leave")\n'
    )
    with load(walls + crowd) as sim:
        walkers, worst, passed = sim.people.component.walkers, 0.0, False
        for _ in range(120):
            sim.step(15)
            here = walkers.present
            if not here.any():
                break
            gap, _ = walkers.ground.clearance(walkers.position[here])
            worst = max(worst, float(np.max(0.9 * walkers.radius[here] - gap)))
            passed |= bool((walkers.position[here, 0] > 11.0).any())
        assert passed
        assert worst < 0.08
