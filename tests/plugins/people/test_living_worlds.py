"""People of the examples are watched for minutes: sliding feet, walls and jitter are counted."""

import numpy as np
import pytest

import morse
from morse.cli.demo import example

MINUTES = 4
#: the examples with a crowd, and the name of the crowd
WORLDS = {"crossroads": "people", "hospital": "visitors"}
#: m, in a tick: of a foot that stands, and of one that swings (6 m/s)
SLIDES, JUMPS = 0.005, 0.1
#: m; a foot below stands
ON_GROUND = 0.003


class Watched:
    """Counts what people of a crowd do that people cannot do, from the bodies as they are drawn."""

    def __init__(self, sim, name):
        self.crowd = getattr(sim, name)
        self.component = self.crowd.component
        self.people = np.flatnonzero(~self.component.gait.rides)
        objects = sim.context.world.objects_by_name
        self.legs = [[objects[f"{name} {k} {side} leg"] for side in ("left", "right")] for k in self.people.tolist()]
        self.in_walls = self.runs = self.slides = self.jumps = self.turns = self.floats = 0
        self.trips = np.zeros(len(self.component.riding.area), int)
        self.floor = self.component.riding.area.copy()
        self.turned = np.full(len(self.floor), -np.inf)
        self.before = None
        self.ticks = 0

    def look(self):
        crowd, walkers, data = self.component, self.component.walkers, self.crowd.data
        here, present = data["positions"].copy(), data["present"].copy()
        velocity = data["velocities"][:, :2].copy()
        area = crowd.riding.area.copy()
        on_foot = present & (area < len(crowd.floors.heights))
        soles = np.array([[leg.world_pose()[0] for leg in pair] for pair in self.legs])
        height = soles[:, :, 2] - here[self.people, None, 2]
        self.floats += int((height.min(axis=1) > 0.01)[present[self.people]].sum())
        if on_foot.any():
            self.in_walls += int((crowd.ground.clearance(walkers.position[on_foot])[0] < 0.12).sum())
        if self.before is not None:
            before, were, had, old_soles, old_height, old_area = self.before
            same = present & were & (area == old_area)
            # at most 1.3 times the free speed, and the speed of the lift
            way = here - before
            self.runs += int((np.hypot(*way[same, :2].T) > 1.3 * walkers.free_speed[same] / 60 + 0.002).sum())
            self.runs += int((np.abs(way[same, 2]) > 1.0 / 60 + 1e-6).sum())
            moved = np.linalg.norm(soles - old_soles, axis=2)[same[self.people]]
            stands = (np.maximum(height, old_height) < ON_GROUND)[same[self.people]]
            self.slides += int((stands & (moved > SLIDES)).sum())
            self.jumps += int((moved > JUMPS).sum())
            # two reversals within half a second
            back = same & ((velocity * had).sum(axis=1) < -1e-3)
            self.turns += int((back & (self.ticks - self.turned < 30)).sum())
            self.turned[back] = self.ticks
        arrived = on_foot & (area != self.floor)
        self.trips += arrived
        self.floor = np.where(on_foot, area, self.floor)
        self.before = here, present, velocity, soles, height, area
        self.ticks += 1


@pytest.mark.slow
@pytest.mark.parametrize("name", WORLDS)
def test_people_of_examples_walk_for_minutes(name):
    """Nobody is in a wall, jumps, trembles, floats, or slides on a foot that stands."""
    with morse.load(example(name).scene, seed=2) as sim:
        watched = Watched(sim, WORLDS[name])
        for _ in range(MINUTES * 60 * 60):
            sim.step()
            watched.look()
        assert (watched.in_walls, watched.runs, watched.slides) == (0, 0, 0)
        assert (watched.jumps, watched.turns, watched.floats) == (0, 0, 0)
        if name == "hospital":
            assert (watched.trips >= 4).all()
        assert sim.failures == ()


@pytest.mark.parametrize(
    ("world", "name", "body"),
    [
        ("crossroads", "people", "people"),
        ("crossroads", "cars", "cars car"),
        ("hospital", "visitors", "visitors"),
        ("mall", "visitors", "visitors"),
    ],
)
def test_feet_and_wheels_of_examples_are_on_the_ground_that_is_shown(world, name, body):
    """Most have that ground at their own height, as a ray finds it: slabs on the ground of the world hide no feet."""
    with morse.load(example(world).scene, seed=2) as sim:
        sim.step()
        objects, data = sim.context.world.objects_by_name, getattr(sim, name).data
        heights = []
        for number in np.flatnonzero(data["present"]).tolist():
            x, y, z = data["positions"][number].tolist()
            _, point, _ = objects[f"{body} {number}"].rayCast((x, y, z - 1.0), (x, y, z + 0.1))
            heights.append(np.inf if point is None else z - point[2])
        assert np.median(heights) == pytest.approx(0.0, abs=0.006)
