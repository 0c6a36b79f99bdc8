"""Lines in front of counters, seats and schedules."""

import numpy as np
import pytest

import morse

SCENE = """
from morse.builder import *
bench = Cube("bench")
bench.scale = (0.25, 1.0, 0.225)
bench.translate(-4, 0, 0.225)
bench.static()
{lines}
Environment("empty")
"""


@pytest.fixture
def load(tmp_path):
    def load(lines):
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(lines=lines), "utf-8")
        return morse.load(path)

    return load


def _states(crowd):
    return [crowd.ask(person).result()["state"] for person in range(len(crowd.data["present"]))]


def test_people_stand_in_line_are_served_one_after_the_other_and_leave(load):
    lines = 'c = Crowd("people", 5)\nc.start([(-1, -2), (1, 2)])\nc.goals([(8, 0)], then="queue", wait=2.0)'
    with load(lines) as sim:
        served, lengths = [], []
        for _ in range(60 * 40):
            sim.step()
            walkers = sim.people.component
            back = np.flatnonzero(walkers.agenda.stage == 1)
            for person in back.tolist():
                if person not in [one for one, _ in served]:
                    served.append((person, sim.context.clock.time))
            waiting = np.flatnonzero(walkers.agenda.mode == 9)
            lengths.append(len(waiting))
            if len(waiting) == 4 and len(set(lengths[-240:])) == 1 and len(lengths) > 240:
                # side by side in a row: the nearest ones are half a metre apart, none beside another
                across = walkers.walkers.position[waiting, 1]
                assert np.ptp(across) < 1.0
            if len(served) == 5:
                break
        assert max(lengths) >= 3
        times = [time for _, time in served]
        assert len(times) == 5
        assert np.diff(times).min() >= 2.0 - 0.02
        for _ in range(30):
            sim.step(30)
            if not sim.people.data["present"].any():
                break
        assert set(_states(sim.people)) == {"gone"}


def test_seats_are_taken_by_one_person_each(load):
    """Two seats on a bench and three people: the third one stands, and sits down when a seat is free."""
    lines = (
        'c = Crowd("people", 3, deviation=0.0)\nc.start([(-3, 2), (0, 5)])\n'
        'c.goals([(-4, -0.6), (-4, 0.6)], then="sit", wait=5.0)'
    )
    with load(lines) as sim:
        sat, most, since = set(), 0, {}
        for half_second in range(60):
            sim.step(30)
            crowd = sim.people.component
            seated = np.flatnonzero(crowd.agenda.mode == 10)
            most = max(most, len(seated))
            for person in seated.tolist():
                if crowd._sits()[person]:
                    # it takes 0.6 s to sit down
                    if half_second - since.setdefault(person, half_second) < 2:
                        continue
                    sat.add(person)
                    trunk = sim.context.world.objects_by_name[f"people {person}"].world_pose()[0]
                    # the trunk is as much lower as the hips of somebody who sits are
                    height = crowd.gait.height[person]
                    assert trunk[2] == pytest.approx((0.27 - 0.53) * height, abs=0.01)
                    assert abs(trunk[0] + 4.0) < 0.1
            if len(sat) == 3 and not sim.people.data["present"].any():
                break
        assert most == 2
        assert sat == {0, 1, 2}
        assert set(_states(sim.people)) == {"gone"}


def test_a_seat_before_a_wall_is_taken_and_left_on_the_side_from_which_one_comes(load):
    """The other side of the wall is as near to the seat; whoever sits looks away from it."""
    lines = """
wall = Cube("wall")
wall.scale = (0.05, 20, 1.2)
wall.translate(-4.31, 0, 1.2)
wall.static()
c = Crowd("people", 2, deviation=0.0)
c.start([(-2, 2), (0, 5)])
c.goals([(-4.1, -0.6), (-4.1, 0.6)], then="sit", wait=4.0)
"""
    with load(lines) as sim:
        seated = 0
        for _ in range(120):
            sim.step(15)
            crowd = sim.people.component
            assert (crowd.walkers.position[:, 0] > -4.15).all()
            for person in np.flatnonzero(crowd.agenda.mode == 10).tolist():
                if (
                    crowd.agenda.until[person] - sim.context.clock.time < 2.0
                    and not crowd.agenda.stands_up(np.array([person]))[0]
                ):
                    seated += 1
                    assert crowd.gait.heading[person, 0] > 0.5
            if not sim.people.data["present"].any():
                break
        assert seated
        assert not sim.people.data["present"].any()


def test_a_schedule_sends_people_elsewhere_at_its_times(load):
    lines = (
        'c = Crowd("people", 3)\nc.start([(0, 8), (4, 10)])\n'
        'c.goals([(8, 9)], then=[(6.0, [(1, 9)]), (12.0, [(8, 9)], "leave")])'
    )
    with load(lines) as sim:
        sim.step(60 * 6 - 10)
        assert (sim.people.data["positions"][:, 0] > 6.5).all()
        sim.step(60 * 6)
        assert (sim.people.data["positions"][:, 0] < 2.5).all()
        state = sim.save()
        sim.step(60 * 9)
        assert not sim.people.data["present"].any()
        digest = sim.state_hash()
        sim.restore(state)
        sim.step(60 * 9)
        assert sim.state_hash() == digest


def test_those_who_come_to_a_point_together_do_not_jam(load):
    """Forty people to one point and on: all have passed it after the time of the way and a queue of one lane."""
    lines = 'c = Crowd("people", 40)\nc.start([(0, -3), (6, 3)])\nc.goals([(10, 0), (18, 0)], then="leave")'
    with load(lines) as sim:
        for _ in range(45):
            sim.step(60)
            if not sim.people.data["present"].any():
                break
        assert not sim.people.data["present"].any()


@pytest.mark.parametrize(
    ("then", "message"),
    [
        ("[]", "at least one entry"),
        ("5", r"stay, repeat, queue, sit or a list of \(time, goals\)"),
        ("[5]", r"entries \(time, goals\) or"),
        ("[(1.0, [(0, 0)], 3)]", r"entries \(time, goals\) or"),
        ("[(-1.0, [(0, 0)])]", "-1"),
        ("[(float('nan'), [(0, 0)])]", "nan"),
        ("[(5.0, [(0, 0)]), (5.0, [(1, 1)])]", "times of a schedule increase"),
        ("[(5.0, [])]", "at least one goal"),
        ("[(5.0, [(0, 0)], 'vanish')]", "vanish"),
    ],
)
def test_a_schedule_that_makes_no_sense_is_an_error_with_its_line(load, then, message):
    with pytest.raises(Exception, match=rf"scene\.py:\d+: .*{message}"):
        load(f'c = Crowd("people", 3)\nc.start([(0, 8), (4, 10)])\nc.goals([(8, 9)], then={then})')
