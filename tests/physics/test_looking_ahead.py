"""Robots that drift after a contact check with a large margin are bit-identical to robots checked in every tick."""

import math

import mujoco
import numpy as np
import pytest
from worlds import box, ground, node, rigid, robot, world

from morse.physics.gliding import passage, stances

ROBOTS = 3


def crowded():
    """Robots between walls, with a sleeping box."""
    robots = [robot(f"robot{i}", at=(1.2 * i - 1.2, 0.3 * i, 0.25)) for i in range(ROBOTS)]
    walls = [node(f"Wall{x}", box(0.2, 6, 1), at=(x, 0, 0.5)) for x in (-3.5, 3.5)]
    return world(ground(), rigid("Box", box(0.3, 0.3, 0.3), at=(0.6, 1.8, 0.15)), *walls, *robots, robots=robots)


@pytest.fixture
def looks(monkeypatch):
    """The number of contact checks of the engine."""
    count, look = [0], mujoco.mj_collision

    def counted(model, data):
        count[0] += 1
        look(model, data)

    monkeypatch.setattr(mujoco, "mj_collision", counted)
    return count


def journey(seed, ticks=600):
    """Poses (T, K, 3) of a world whose robots are driven randomly, slowly and suddenly fast."""
    numbers, w, places = np.random.default_rng(seed), crowded(), []
    for tick in range(ticks):
        if tick % 15 == 0:
            speeds = numbers.choice([0.02, 0.2, 2.0], size=ROBOTS, p=[0.5, 0.4, 0.1])
            rates = numbers.uniform(-1.0, 1.0, size=ROBOTS)
        for i, (v, rate) in enumerate(zip(speeds.tolist(), rates.tolist(), strict=True)):
            w.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, rate), ground=True)
        w.step()
        places.append(w.positions.array.copy())
    return np.array(places)


@pytest.mark.parametrize("seed", range(6))
def test_the_same_bits_as_with_a_look_in_every_tick(monkeypatch, looks, seed):
    ahead = journey(seed)
    assert looks[0] > 0
    for module in (passage, stances):
        monkeypatch.setattr(module, "FORESIGHT", 1)
    assert np.array_equal(ahead, journey(seed))


def test_a_robot_with_room_around_it_is_looked_at_in_one_of_eight_ticks(looks):
    w = crowded()
    for _ in range(120):
        w.game_object("robot1").drive((0.0, 0, 0), (0, 0, 0.5), ground=True)
        w.step()
    looks[0] = 0
    for _ in range(80):
        w.game_object("robot1").drive((0.0, 0, 0), (0, 0, 0.5), ground=True)
        w.step()
    assert looks[0] <= 10


@pytest.mark.parametrize("speed", [3.0, 8.0])
def test_who_dashes_off_after_a_look_still_meets_the_wall(speed):
    w = crowded()
    for _ in range(90):
        w.game_object("robot2").drive((0.02, 0, 0), (0, 0, 0), ground=True)
        w.step()
    for _ in range(120):
        w.game_object("robot2").drive((speed, 0, 0), (0, 0, 0), ground=True)
        w.step()
    assert 2.9 < w.game_object("robot2").worldPosition.x < 3.5


def test_what_comes_into_the_way_of_a_robot_is_met():
    w = crowded()
    for tick in range(240):
        if tick == 120:
            assert w.gliding.clear_until > w.gliding.tick
            x, y, _ = w.game_object("robot1").worldPosition
            w.game_object("Box").worldPosition = (x + 0.5, y, 0.15)
        w.game_object("robot1").drive((0.3, 0, 0), (0, 0, 0), ground=True)
        w.step()
    (x, y, _), (bx, by, _) = w.game_object("robot1").worldPosition, w.game_object("Box").worldPosition
    assert math.hypot(bx - x, by - y) > 0.35
