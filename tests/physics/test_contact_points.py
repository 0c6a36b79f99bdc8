"""Contact points, for observers."""

import numpy as np
import pytest
from worlds import box, ground, rigid, robot, run, world

MASS = 12.0


def driven_world():
    body = robot(mass=MASS)
    return world(ground(), body, rigid("Box", box(0.5, 0.5, 0.5), at=(1.5, 0, 0.25), mass=1.0), robots=[body])


def drive(w):
    w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True)


def contacts(w):
    return np.frombuffer(w.contact_forces(), dtype=np.float32).reshape(-1, 6)


@pytest.mark.parametrize("seconds", [0.5, 5.0], ids=["awake", "asleep"])
def test_contact_forces_carry_the_weight(seconds):
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0.25), mass=7.0))
    run(w, seconds)
    rows = contacts(w)
    assert np.abs(rows[:, 2]).max() < 1e-2
    assert rows[:, 5].sum() == pytest.approx(7.0 * 9.81, rel=0.02)


def test_a_robot_that_glides_is_seen_to_stand_on_its_feet():
    w = driven_world()
    run(w, 1.0, lambda: drive(w))
    assert w.gliding.supports()
    rows = contacts(w)
    feet = rows[rows[:, 0] < 1.0]
    assert len(feet) == 4
    assert feet[:, 2] == pytest.approx(0.0, abs=0.01)
    assert feet[:, 5].sum() == pytest.approx(MASS * 9.81, rel=0.02)


def test_looking_at_contacts_changes_nothing():
    seen, unseen = driven_world(), driven_world()
    for _ in range(200):
        for w in (seen, unseen):
            drive(w)
            w.step()
        contacts(seen)
        assert seen.data.qpos.tobytes() == unseen.data.qpos.tobytes()
        assert seen.data.qvel.tobytes() == unseen.data.qvel.tobytes()
