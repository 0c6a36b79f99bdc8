"""People of a world are watched for four minutes: sliding feet, walls and jitter are counted."""

import numpy as np
import pytest

import morse
from morse.cli.demo import example

MINUTES = 4


@pytest.mark.slow
def test_visitors_of_the_hospital_walk_and_ride_for_minutes():
    """Nobody is in a wall, jumps, or slides on a foot that stands; everybody changes floors."""
    with morse.load(example("hospital").scene, seed=2) as sim:
        crowd = sim.visitors.component
        walkers, gait, riding = crowd.walkers, crowd.gait, crowd.riding
        people = np.arange(len(riding.area))
        before, floor, trips = sim.visitors.data["positions"].copy(), riding.area.copy(), np.zeros(len(people), int)
        foot, stood = np.floor(gait.phase).astype(int), gait.stands.copy()
        feet, area = gait.feet.copy(), riding.area.copy()
        in_walls = jumps = slides = 0
        for _ in range(MINUTES * 60 * 60):
            sim.step()
            here = sim.visitors.data["positions"]
            on_foot = riding.area < 2
            in_walls += int((crowd.ground.clearance(walkers.position[on_foot])[0] < 0.12).sum())
            # at most 1.3 times the free speed, and the speed of the lift
            way = np.hypot(*(here - before)[:, :2].T)
            jumps += int((way > 1.3 * walkers.free_speed / 60 + 0.002).sum())
            jumps += int((np.abs(here - before)[:, 2] > 1.0 / 60 + 1e-6).sum())
            step = np.floor(gait.phase).astype(int)
            same = (step == foot) & ~stood & ~gait.stands & (riding.area == area)
            moved = np.abs(gait.feet[people, step % 2] - feet[people, step % 2]).max(axis=1)
            slides += int((same & (moved > 1e-9)).sum())
            arrived = on_foot & (riding.area != floor)
            trips += arrived
            floor = np.where(on_foot, riding.area, floor)
            before, foot, stood = here.copy(), step, gait.stands.copy()
            feet, area = gait.feet.copy(), riding.area.copy()
        assert (in_walls, jumps, slides) == (0, 0, 0)
        assert (trips >= 4).all()
        assert sim.failures == ()
