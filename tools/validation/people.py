"""People: the tests of RiMEA 4.1.1 (appendix 1), doors, contacts and steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from figures import Figure, scene

from morse.plugins.people.contacts import REGIONS, press
from morse.plugins.people.gait import Gait
from morse.plugins.people.walking import Orca, Others, SocialForce, Walkers
from morse.plugins.people.wayfinding import Ground

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

_TICK = 1.0 / 60.0
_MODELS = {"social force": SocialForce(), "ORCA": Orca()}


def figures() -> Iterator[Figure]:
    """Measure all figures."""
    for name, model in _MODELS.items():
        time = corridor(model)
        yield Figure(
            f"{name}, RiMEA 1: 40 m at 1.33 m/s", "time, s", 40.0 / 1.33, time, 0.6, "40 m / v, and 0.5 s to start"
        )
    for name, model in _MODELS.items():
        for density in (0.5, 1.0, 2.0):
            expected = 1.34 * (1.0 - math.exp(-1.913 * (1.0 / density - 1.0 / 5.4)))
            speed = speed_in_a_crowd(model, density)
            model_name = f"{name}, RiMEA 4: {density:g} persons/m²"
            yield Figure(
                model_name, "speed, m/s", expected, speed, 0.25, "Weidmann 1993: 1.34 (1 − exp(−1.913 (1/ρ − 1/5.4)))"
            )
    one, two = (leaving(SocialForce(), 80, exits, 7.0) for exits in ([3.5], [1.75, 5.25]))
    # the last ones are slow walkers, who come when nobody is in their way
    ratio = one[-5] / two[-5]
    yield Figure(
        "social force, RiMEA 9: 1 and 2 exits", "ratio of the times, 95 %", 2.0, ratio, 0.15, "twice the exits"
    )
    middle = one[8:-5]
    flow = (len(middle) - 1) / (middle[-1] - middle[0])
    yield Figure("social force, door of 1 m", "flow, 1/(m s)", 1.25, flow, 0.08, "Weidmann 1993: 1.2 to 1.3")
    yield from contact()
    yield steps()
    for word, number, published in (("up", 2, 0.610), ("down", 3, 0.694)):
        yield Figure(
            f"stairs of 31°, {word}, RiMEA {number}",
            "speed along the ground, m/s",
            published,
            on_stairs(upward=word == "up"),
            0.02,
            "Weidmann 1993, of people who walk at 1.34 m/s",
        )


def box(x: float, y: float, u: float, v: float) -> Floats:
    """Return a wall between two corners, m."""
    return np.array([(x, y), (u, y), (u, v), (x, v)])


def ground(polygons: Sequence[Floats], low: tuple[float, float], high: tuple[float, float]) -> Ground:
    """Return the ground between two corners, m."""
    return Ground(polygons, np.array(low), np.array(high), 0.2)


def corridor(model: SocialForce | Orca) -> float:
    """Return the time for 40 m of a corridor of 2 m, s."""
    floor = ground([box(-2, -1.5, 43, -1), box(-2, 1, 43, 1.5)], (-3, -3), (45, 3))
    way = floor.way_to(floor.cells_in(box(41.5, -1, 42.5, 1)))
    walker = Walkers.at(floor, np.array([(0.0, 0.0)]), 1.33, 0.2)
    ticks = 0
    while walker.position[0, 0] < 40.0 and ticks < 3000:
        walker.wanted = floor.heading(way, walker.position)
        walker.step(_TICK, model)
        ticks += 1
    return ticks * _TICK


def speed_in_a_crowd(model: SocialForce | Orca, density: float, seconds: float = 8.0) -> float:
    """Return the mean speed, m/s, in a corridor of 16 m by 2 m whose ends are joined."""
    long, wide, rows = 16.0, 2.0, 4
    random = np.random.default_rng(4)
    count = round(density * long * wide)
    sides = [box(-9, -wide / 2 - 0.5, long + 9, -wide / 2), box(-9, wide / 2, long + 9, wide / 2 + 0.5)]
    floor = ground(sides, (-6, -wide / 2 - 1), (long + 6, wide / 2 + 1))
    across = [(k % rows + 0.5) * wide / rows - wide / 2 for k in range(count)]
    spots = np.stack([(np.arange(count) // rows + 0.5) * long / math.ceil(count / rows), across], axis=1)
    speeds = np.clip(random.normal(1.34, 0.26, count), 0.82, 1.86)
    walkers = Walkers.at(floor, spots + random.normal(0, 0.03, spots.shape), speeds, 0.2)
    walkers.wanted[:, 0] = 1.0
    means = []
    for tick in range(round(seconds * 60)):
        walkers.step(_TICK, model, beyond(walkers, long, 4.0))
        walkers.position[:, 0] %= long
        if tick > seconds * 30:
            means.append(walkers.velocity[:, 0].mean())
    return float(np.mean(means))


def beyond(walkers: Walkers, long: float, reach: float) -> Others:
    """Return those near the ends of a corridor, whose ends are joined, as they are seen from the other end."""
    left, right = walkers.position[:, 0] < reach, walkers.position[:, 0] > long - reach
    count = int(left.sum() + right.sum())
    return Others(
        np.concatenate([walkers.position[left] + (long, 0), walkers.position[right] - (long, 0)]),
        np.concatenate([walkers.velocity[left], walkers.velocity[right]]),
        np.full(count, 0.2),
        np.ones((len(walkers.position), count), dtype=bool),
    )


def leaving(model: SocialForce | Orca, count: int, exits: Sequence[float], size: float) -> Floats:
    """Return the times, s, at which people leave a square room by exits of 1 m in its right wall."""
    random = np.random.default_rng(2)
    sides = [box(-0.5, -0.5, 0, size + 0.5), box(0, -0.5, size, 0), box(0, size, size, size + 0.5)]
    y = 0.0
    for middle in exits:
        sides.append(box(size, y, size + 0.5, middle - 0.5))
        y = middle + 0.5
    sides.append(box(size, y, size + 0.5, size + 0.5))
    floor = ground(sides, (-2, -2), (size + 6, size + 2))
    way = floor.way_to(floor.cells_in(box(size + 3, -1, size + 5, size + 1)))
    columns = math.ceil(math.sqrt(count))
    pitch = (size - 1.0) / columns
    spots = np.array([(0.5 + pitch * (k // columns + 0.5), 0.5 + pitch * (k % columns + 0.5)) for k in range(count)])
    walkers = Walkers.at(floor, spots, np.clip(random.normal(1.34, 0.26, count), 0.82, 1.86), 0.2)
    times = np.full(count, np.inf)
    for tick in range(60 * 120):
        walkers.wanted = floor.heading(way, walkers.position)
        walkers.step(_TICK, model)
        times[np.isinf(times) & (walkers.position[:, 0] > size + 0.25)] = tick * _TICK
        walkers.present &= walkers.position[:, 0] < size + 2.0
        if np.isfinite(times).all():
            break
    return np.sort(times)


def contact() -> Iterator[Figure]:
    """The impact of a robot of 60 kg at 0.5 m/s on the chest; and of a crate that slides into a person of a crowd."""
    region = next(one for one in REGIONS if one.name == "chest")
    overlap, closing, peak, reduced = 0.0, 0.5, 0.0, 1.0 / (1.0 / 75.0 + 1.0 / 60.0)
    for _ in range(60):
        impulse, force, _ = press(overlap, closing, _TICK, region, 60.0, 75.0)
        overlap += _TICK * (closing - 0.5 * impulse / reduced)
        closing -= impulse / reduced
        peak = max(peak, force)
    expected = 0.5 * math.sqrt(reduced * region.stiffness)
    yield Figure(
        "impact of 60 kg at 0.5 m/s, chest", "largest force, N", expected, peak, 0.2 * expected, "ISO/TS 15066, A.3.4"
    )
    text = """
crowd = Crowd("people", 1, deviation=0.0)
crowd.start(places=[(2.0, 0.0)])
crate = Cube("crate"); crate.scale = (0.3, 0.3, 0.15); crate.translate(1.2, 0.0, 0.151)
crate.set_rigid_body(); crate.set_mass(60.0); crate.set_friction(0.0); crate.set_damping(0.0, 0.0)
env = Environment("empty")
"""
    with scene(text) as sim:
        body, mass = sim.context.world.objects_by_name["crate"], float(sim.people.component.walkers.mass[0])
        # nobody gives way to what he does not see
        sim.people.component.agenda.alert[:] = 2.0
        sim.step(5)
        body.set_velocity((0.5, 0.0, 0.0), None)
        peak = 0.0
        for _ in range(90):
            sim.step()
            peak = max([peak, *(one["force"] for one in sim.people.data["contacts"])])
    legs = next(one for one in REGIONS if one.name == "lower legs")
    expected = 0.5 * math.sqrt(legs.stiffness / (1.0 / 60.0 + 1.0 / mass))
    yield Figure(
        "crate of 60 kg, 0.5 m/s, against legs",
        "largest force, N",
        expected,
        peak,
        0.25 * expected,
        "v √(µk), ISO/TS 15066",
    )


def steps() -> Figure:
    """The length of the steps at 1.34 m/s."""
    gait = Gait.at(np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.array([1.72]), np.zeros(1, dtype=bool), np.zeros(1))
    velocity, position, begin = np.array([[1.34, 0.0]]), np.zeros((1, 2)), float(gait.phase[0])
    for _ in range(60 * 10):
        position = position + _TICK * velocity
        gait.step(_TICK, position, velocity, np.zeros((1, 2)), np.zeros(1, dtype=bool))
    length = 13.4 / (float(gait.phase[0]) - begin)
    return Figure(
        "steps at 1.34 m/s",
        "length, m",
        0.717,
        length,
        0.03,
        "walk ratio 0.0064 m/(steps/min), Sekiya and Nagasaki 1998",
    )


def on_stairs(*, upward: bool) -> float:
    """Measure the speed along the ground of somebody who walks stairs, m/s."""
    run = 19 * 0.29
    plans = [
        ("(-2.0, 0.0)", "(9, 0, 3.5)"),
        ("(9.0, 0.0, 3.5)", "(-3, 0)"),
    ]
    begin, end = plans[0 if upward else 1]
    text = (
        'stairs = Stairs(rise=3.5, tread=0.29)\nupper = Cube("upper")\nupper.scale = (3.0, 3.0, 0.1)\n'
        "upper.translate(8.51, 0, 3.4)\nupper.static()\npeople = Crowd(count=1, floors=(0.0, 3.5), deviation=0.0)\n"
        f"people.start(places=[{begin}])\npeople.goals([{end}])\nEnvironment('empty')"
    )
    with scene(text) as simulation:
        places = []
        for _ in range(60 * 16):
            simulation.step()
            places.append(float(simulation.people.data["positions"][0, 0]))
    inside = [number for number, place in enumerate(places) if 0.5 < place < run - 0.5]
    way = abs(places[inside[-1]] - places[inside[0]])
    return way / (_TICK * (inside[-1] - inside[0]))
