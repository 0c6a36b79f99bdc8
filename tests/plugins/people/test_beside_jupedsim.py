"""The same geometries in JuPedSim, with its models: our people are within the spread of theirs."""

import math
from itertools import pairwise

import numpy as np
import pytest

from morse.plugins.people.walking import SocialForce, Walkers
from morse.plugins.people.wayfinding import Ground

jupedsim = pytest.importorskip("jupedsim", reason="jupedsim is not installed: pip install jupedsim")
shapely = pytest.importorskip("shapely", reason="shapely is not installed: pip install shapely")

pytestmark = pytest.mark.slow

TICK = 1.0 / 60.0
#: name of a model of JuPedSim, and of the parameter that is the free speed
MODELS = {"CollisionFreeSpeedModel": "desired_speed", "AnticipationVelocityModel": "desired_speed"}


def box(x, y, u, v):
    return [(x, y), (u, y), (u, v), (x, v)]


def theirs(model, rooms, goal, spots, speeds, line):
    """Return the times (N,) at which people pass a line, a function of (x, y), s, sorted; and their tracks."""
    area = shapely.union_all([shapely.Polygon(room) for room in rooms])
    simulation = jupedsim.Simulation(model=getattr(jupedsim, model)(), geometry=area, dt=0.01)
    stage = simulation.add_exit_stage(goal)
    journey = simulation.add_journey(jupedsim.JourneyDescription([stage]))
    parameters = getattr(jupedsim, f"{model}AgentParameters")
    for spot, speed in zip(spots, speeds, strict=True):
        values = {"position": tuple(spot), "journey_id": journey, "stage_id": stage, "radius": 0.2}
        simulation.add_agent(parameters(**values, **{MODELS[model]: float(speed)}))
    passed, tracks = {}, {}
    while simulation.agent_count() and simulation.elapsed_time() < 200.0:
        simulation.iterate()
        for agent in simulation.agents():
            tracks.setdefault(agent.id, []).append(agent.position)
            if agent.id not in passed and line(*agent.position):
                passed[agent.id] = simulation.elapsed_time()
    return np.sort(list(passed.values())), tracks


def ours(walls, goal, spots, speeds, line):
    every = np.concatenate([np.array(wall) for wall in walls])
    ground = Ground([np.array(wall, dtype=float) for wall in walls], every.min(axis=0) - 1, every.max(axis=0) + 6, 0.2)
    way = ground.way_to(ground.cells_in(np.array(goal, dtype=float)))
    walkers = Walkers.at(ground, np.array(spots), np.array(speeds, dtype=float), 0.2)
    passed, tracks = {}, {person: [] for person in range(len(spots))}
    for tick in range(60 * 200):
        walkers.wanted = ground.heading(way, walkers.position)
        walkers.step(TICK, SocialForce())
        for person in np.flatnonzero(walkers.present).tolist():
            tracks[person].append(tuple(walkers.position[person]))
            if person not in passed and line(*walkers.position[person]):
                passed[person] = tick * TICK
        walkers.present &= ground.time(way, walkers.position) > 0.3
        if len(passed) == len(spots):
            break
    return np.sort(list(passed.values())), tracks


def test_a_corridor_takes_as_long():
    """RiMEA 1: half a second to start is all that differs."""
    spots, speeds = [(0.5, 0.0)], [1.33]
    times = []
    for model in MODELS:
        (time,), _ = theirs(model, [box(0, -1, 44, 1)], box(42, -1, 44, 1), spots, speeds, lambda x, y: x > 40.5)
        times.append(time)
    (own,), _ = ours([box(-1, -2, 45, -1), box(-1, 1, 45, 2)], box(42, -1, 44, 1), spots, speeds, lambda x, y: x > 40.5)
    assert min(times) - 0.2 < own < max(times) + 0.8


def test_a_corner_is_turned_on_as_long_a_way():
    """RiMEA 6: the length of the way around a corner, which depends on how closely it is cut."""
    spots, speeds = [(0.5, 1.0)], [1.34]
    line, goal = (lambda x, y: y > 9.0), box(10, 10.5, 12, 11.5)

    def size(tracks):
        (track,) = tracks.values()
        until = next(k for k, place in enumerate(track) if line(*place))
        return sum(math.dist(a, b) for a, b in pairwise(track[: until + 1]))

    rooms = [box(0, 0, 12, 2), box(10, 2, 12, 12)]
    lengths = [size(theirs(model, rooms, goal, spots, speeds, line)[1]) for model in MODELS]
    walls = [box(-1, -1, 13, 0), box(-1, 2, 10, 3), box(-1, -1, 0, 3), box(12, 0, 13, 12), box(9, 2, 10, 12)]
    own = size(ours(walls, goal, spots, speeds, line)[1])
    assert min(lengths) - 1.0 < own < max(lengths) + 1.0


def test_people_leave_a_room_in_the_times_of_its_models():
    """40 people, a door of 1 m: the times at which 10, 20, 30 have left are within the spread of models and seeds."""
    room, tube = box(0, 0, 6, 6), box(5.9, 2.5, 9, 3.5)
    line, goal = (lambda x, y: x > 6.25), box(8, 2.5, 9, 3.5)
    curves = []
    for seed in (1, 2):
        random = np.random.default_rng(seed)
        spots = [(0.6 + 0.75 * (k // 7), 0.6 + 0.8 * (k % 7)) for k in range(40)]
        speeds = np.clip(random.normal(1.34, 0.26, 40), 0.82, 1.86)
        curves += [theirs(model, [room, tube], goal, spots, speeds, line)[0] for model in MODELS]
    walls = [box(-1, -1, 0, 7), box(0, -1, 7, 0), box(0, 6, 7, 7), box(6, 0, 6.5, 2.5), box(6, 3.5, 6.5, 6)]
    walls += [box(6, 2, 9, 2.5), box(6, 3.5, 9, 4)]
    own, _ = ours(walls, goal, spots, speeds, line)
    for count in (10, 20, 30):
        # a run of theirs may jam
        times = [curve[count] for curve in curves if len(curve) > count]
        assert len(times) >= 2
        assert 0.8 * min(times) < own[count] < 1.2 * max(times)
