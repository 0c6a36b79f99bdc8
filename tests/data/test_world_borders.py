"""Robots do not fall off the worlds: every way over the ground ends at something."""

import numpy as np
import pytest

import morse
from morse.builder import Environment, FakeRobot
from morse.simulation.simulation import Simulation

#: m: between two places that are looked at; height over the ground at which something stops a robot
STEP, BUMPER = 1.0, 0.35
#: m: a robot climbs no higher within a step, and one that drops deeper than this has fallen off
CLIMB, DEEPEST = 0.7, 8.0
#: m: places from which the robot goes, if not the origin: before a door; in the room and in the passage
STARTS = {"laas/grande_salle": [(-4.6, -9.0)], "tum_kitchen/tum_kitchen": [(2.0, 2.0), (7.6, 3.0)]}
UP = np.array([0.0, 0.0, 1.0])
WAYS = np.array([(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)])


def distances(simulation: Simulation, begin: np.ndarray, along: np.ndarray, reach: float) -> np.ndarray:
    """The free distances from (N, 3) places in (N, 3) directions of the world, m; infinite for no hit."""
    robot = simulation.context.robots["robot"].bge_object
    origins = begin - np.array(robot.worldPosition)
    bundle = simulation.context.world.rays.bundle(robot, along, reach, origins, upright=True)
    bundle.refresh()
    return np.array(bundle.distances)


def lost_places(simulation: Simulation, starts: list[tuple[float, float]]) -> list[list[float]]:
    """The places at which a robot falls off that goes from the starts wherever nothing stops it."""
    here = np.array([[*start, 0.0] for start in starts])
    known = {(round(x / STEP), round(y / STEP)) for x, y in starts}
    lost: list[list[float]] = []
    while len(here):
        begin = np.repeat(here, len(WAYS), axis=0) + BUMPER * UP
        along = np.tile(WAYS, (len(here), 1))
        free = distances(simulation, begin, along, STEP) > STEP
        there = (begin + STEP * along)[free]
        cells = [tuple(cell) for cell in np.round(there[:, :2] / STEP).astype(int).tolist()]
        new = {cell: row for row, cell in enumerate(cells) if cell not in known}
        known |= new.keys()
        there = there[list(new.values())]
        if not len(there):
            break
        above = there + (CLIMB - BUMPER) * UP
        depth = distances(simulation, above, np.tile(-UP, (len(above), 1)), DEEPEST)
        lost += there[np.isinf(depth)].tolist()
        # a step from inside of a hill is none
        good = np.isfinite(depth) & (depth > 0.01)
        here = above[good] - depth[good, None] * UP
    assert len(known) > 40
    return lost


@pytest.mark.parametrize(
    "world",
    [
        "laas/grande_salle",
        "tum_kitchen/tum_kitchen",
        "outdoors",
        "land-1/trees",
        pytest.param("land-1/buildings_2", marks=pytest.mark.slow),
        pytest.param("land-1/rosace_1", marks=pytest.mark.slow),
        "indoors-1/boxes",
        "indoors-1/indoor-1",
        "indoors-1/office",
        "indoors-1/warehouse",
    ],
)
def test_no_way_over_the_ground_ends_in_the_air(world: str) -> None:
    def scene() -> None:
        robot = FakeRobot("robot")
        robot.translate(z=50.0)
        Environment(world, fastmode=True)

    with morse.load(scene) as simulation:
        simulation.step(1)
        lost = lost_places(simulation, STARTS.get(world, [(0.0, 0.0)]))
    assert lost == [], f"a robot falls at {np.round(lost[:5], 1).tolist()} and {len(lost) - 5} other places"
