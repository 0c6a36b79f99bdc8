"""People walk stairs: at the published speeds, with their feet on the steps, and from floor to floor without a jump."""

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError

RISE, TREAD, STEPS = 3.5, 0.29, 20
RUN = TREAD * (STEPS - 1)
SCENE = """
from morse.builder import *
stairs = Stairs("stairs", rise=3.5, width={width}, tread=0.29, riser=0.175)
upper = Cube("upper")
upper.scale = (3.0, 3.0, 0.1)
upper.translate(8.51, 0, 3.4)
upper.static()
people = Crowd("people", {count}, floors=(0.0, 3.5), deviation=0.0{more})
{plan}
Environment("empty")
"""


@pytest.fixture
def load(tmp_path):
    def load(plan, count=1, width=1.5, more=""):
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(plan=plan, count=count, width=width, more=more), "utf-8")
        return morse.load(path)

    return load


UP = "people.start(places=[(-2.0, 0.0)])\npeople.goals([(9, 0, 3.5)])"
DOWN = "people.start(places=[(9.0, 0.0, 3.5)])\npeople.goals([(-3, 0)])"


def height_of(along):
    """The height of the step at a place along the stairs, m."""
    return np.where(along >= RUN, RISE, np.clip(np.floor(along / TREAD) + 1.0, 0.0, None) * RISE / STEPS)


@pytest.mark.parametrize(("plan", "published"), [(UP, 0.610), (DOWN, 0.694)], ids=["up", "down"])
def test_people_walk_stairs_at_the_published_speed_with_their_feet_on_the_steps(load, plan, published):
    """RiMEA 2 and 3, with the speeds along the ground of Weidmann 1993: 0.610 m/s up, 0.694 m/s down."""
    with load(plan) as sim:
        crowd, places, trunks, feet = sim.people.component, [], [], []
        for _ in range(60 * 20):
            sim.step()
            places.append(sim.people.data["positions"][0].copy())
            trunks.append(crowd._bodies[0].world_pose()[0])
            gait = crowd.gait
            foot = int(gait.phase[0]) % 2
            feet.append((*crowd._bodies[1 + foot].world_pose()[0], gait.stands[0]))
        places, trunks, feet = np.array(places), np.array(trunks), np.array(feet)
        on_steps = (places[:, 0] > 0.5) & (places[:, 0] < RUN - 0.5)
        times = np.flatnonzero(on_steps)
        way = abs(places[times[-1], 0] - places[times[0], 0])
        assert way / (times[-1] - times[0]) * 60.0 == pytest.approx(published, rel=0.03)
        # the line through the middles of the steps, without a jump from floor to floor
        line = np.clip(RISE / STEPS * (places[:, 0] / TREAD + 0.5), 0.0, RISE)
        assert places[:, 2] == pytest.approx(line, abs=0.02)
        assert np.abs(np.diff(places[:, 2])).max() < 0.03
        beside = (places[1:, 0] > -0.5) & (places[1:, 0] < RUN + 0.5)
        assert np.abs(np.diff(trunks[:, 2]))[beside].max() < 0.035
        # the supporting foot stands on its step, in its middle
        standing = on_steps & (feet[:, 3] == 0.0)
        assert np.abs(feet[standing, 2] - height_of(feet[standing, 0])).max() < 0.04
        middles = np.mod(feet[standing, 0], TREAD) / TREAD
        assert np.abs(middles - 0.5).max() < 0.3
        # one step after the other
        landed = np.unique(np.floor(feet[standing, 0] / TREAD))
        assert len(landed) >= STEPS - 6
        end = places[-1]
        assert end[2] == (RISE if plan is UP else 0.0)
        assert abs(end[0] - (9.0 if plan is UP else -3.0)) < 0.6
        assert not sim.failures


def test_people_who_meet_on_stairs_pass_each_other_and_nobody_leaves_them_aside(load):
    plan = """
people.start([(-4, -2), (-1, 2)], 5, goals=[(9, 0, 3.5)])
people.start([(6.5, -2, 3.5), (11, 2, 3.5)], 5, goals=[(-3, 0)])
"""
    with load(plan, 10, 2.0) as sim:
        closest = np.inf
        for _ in range(60 * 5):
            sim.step(5)
            places = sim.people.data["positions"]
            inside = (places[:, 0] > 0.2) & (places[:, 0] < RUN - 0.2) & (places[:, 2] > 0.1) & (places[:, 2] < 3.4)
            assert (np.abs(places[inside, 1]) < 1.0).all()
            # who is above the lower floor, and not on the upper one, is on the stairs
            between = (places[:, 2] > 0.0) & (places[:, 2] < RISE)
            assert ((places[between, 0] > -0.2) & (places[between, 0] < RUN + 0.2)).all()
            apart = np.sqrt(((places[:, None] - places[None]) ** 2).sum(axis=2)) + 9.0 * np.eye(10)
            closest = min(closest, apart.min())
            up = (places[:5, 2] == RISE).all() and (places[5:, 2] == 0.0).all()
            if up:
                break
        assert up
        # bodies have a diameter of 0.4 m, and yield a little
        assert closest > 0.2
        state = sim.save()
        sim.step(60)
        after = sim.people.data["positions"].copy()
        sim.restore(state)
        sim.step(60)
        assert (sim.people.data["positions"] == after).all()


def test_wheelchairs_take_the_lift_and_not_the_stairs(load):
    lift = 'lift = Lift("lift", levels=(0.0, 3.5))\nlift.translate(3.0, 6.0)\nlift.rotate(z=3.14159265)\n'
    plan = "people.start([(-4, -2), (-1, 2)])\npeople.goals([(9, 0, 3.5)])"
    with load(plan, 2, more=", wheelchairs=0.5") as sim:
        sim.step()
        assert sim.people.ask(0).result()["state"] == "stopped"
        assert sim.people.ask(1).result()["state"] == "walks"
    with load(lift + plan, 2, more=", wheelchairs=0.5") as sim:
        crowd = sim.people.component
        (stage,) = crowd.plan.flows[0]["ways"]
        assert stage.level is not None
        # who sits has the longer way, through the lift, and nobody leads it to the stairs
        assert crowd.walkers.time_on(stage, np.array([0]))[0] > crowd.walkers.time_on(stage, np.array([1]))[0] + 3.0


@pytest.mark.parametrize(
    "line",
    ["Stairs(rise=0.0)", "Stairs(rise=float('nan'))", "Stairs(width=1e9)", "Stairs(tread='deep')", "Stairs(riser=0.0)"],
)
def test_stairs_that_nobody_can_walk_are_refused(load, line):
    with pytest.raises(MorseError, match=r"Stairs\("):
        load(line).close()
