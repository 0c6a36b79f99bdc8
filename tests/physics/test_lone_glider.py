"""The tick of a lone glider gives the bits that the parts of the physics give one by one."""

from __future__ import annotations

import random

import numpy as np
import pytest
from worlds import bits, box, ground, node, rigid, robot, world

from morse.physics.driving.drives import Drives

TICKS = 900


class Twins:
    """The same world twice; one of them takes no short cut."""

    def __init__(self, *others, **settings):
        def make():
            body = robot(at=(0, 0, 0.25), **settings)
            return world(ground(), body, *(other() for other in others), robots=[body])

        self.short, self.long = make(), make()
        self.long._lone_glider.step = lambda: False
        self.taken = 0
        step = self.short._lone_glider.step

        def counted():
            taken = step()
            self.taken += taken
            return taken

        self.short._lone_glider.step = counted

    def run(self, ticks, act):
        """``act(world, tick)`` before each tick; the states are equal after each tick."""
        for tick in range(ticks):
            for twin in (self.short, self.long):
                act(twin, tick)
                twin.step()
            short, long = self.short, self.long
            for name in ("qpos", "qvel", "xpos", "xmat", "time"):
                assert np.array_equal(getattr(short.data, name), getattr(long.data, name)), name
            if tick % 50 == 49:
                assert bits(short.get_state()) == bits(long.get_state())


def drive(world, v, w, aside=0.0, shift=False):
    world.game_object("robot").drive((v, aside, 0), (0, 0, w), ground=True, position=shift)


def wall():
    return node("wall", box(0.1, 4.0, 1.0), at=(3.0, 0, 0.5))


def crate():
    return rigid("crate", box(0.4, 0.4, 0.4), at=(-3.0, 0, 0.2))


def test_a_circle_has_the_same_bits():
    twins = Twins()
    twins.run(TICKS, lambda w, tick: drive(w, 0.5, 0.7))
    assert twins.taken > 0.8 * TICKS


@pytest.mark.parametrize("seed", range(4))
def test_commands_of_all_kinds_have_the_same_bits(seed):
    chance = random.Random(seed)
    plan = []
    while len(plan) < TICKS:
        command = (
            chance.choice((0.0, 0.4, 1.5, chance.uniform(-2, 2))),
            chance.choice((0.0, 0.3, chance.uniform(-3, 3))),
            chance.choice((0.0, 0.0, 0.5)),
            chance.random() < 0.3,
        )
        plan += [None if chance.random() < 0.1 else command] * chance.randint(1, 40)
    twins = Twins(wall, crate)

    def act(w, tick):
        if plan[tick] is not None:
            drive(w, *plan[tick])
        if tick == 400:
            w.game_object("crate").set_velocity((0.5, 0.2, 1.0), None)
        if tick == 500:
            w.game_object("robot").worldPosition = [0.3, 0.2, 0.25]
        if tick == 600:
            w.game_object("robot").wrench((0, 0, 60.0), (0, 0, 0), local=False)

    twins.run(TICKS, act)
    assert twins.taken > 0.2 * TICKS


def test_a_wall_and_a_crate_are_met_in_the_same_tick():
    twins = Twins(wall, crate)
    twins.run(TICKS, lambda w, tick: drive(w, 0.8 if tick < 400 else -0.8, 0.0))
    assert twins.taken > 0.1 * TICKS


def test_a_restored_state_goes_on_with_the_same_bits():
    twins = Twins(wall)
    twins.run(303, lambda w, tick: drive(w, 0.3, 0.5))
    for twin in (twins.short, twins.long):
        twin.set_state(twin.get_state())
    twins.run(200, lambda w, tick: drive(w, 0.3, 0.5))


def test_two_robots_take_the_general_way():
    def make():
        first, second = robot(at=(0, 0, 0.25)), robot("other", at=(4, 0, 0.25))
        return world(ground(), first, second, robots=[first, second])

    both = make()
    for _ in range(300):
        drive(both, 0.2, 0.3)
        both.game_object("other").drive((0.2, 0, 0), (0, 0, 0.1), ground=True)
        both.step()
        assert len(both.gliding.glides) < 2 or not both._lone_glider.step()


def test_driving_another_body_at_once_takes_the_general_way():
    twins = Twins(crate)
    twins.run(200, lambda w, tick: drive(w, 0.2, 0.2))
    taken = twins.taken

    def both(w, tick):
        drive(w, 0.2, 0.2)
        w.game_object("crate").drive((0.1, 0, 0), (0, 0, 0))

    twins.run(50, both)
    assert twins.taken == taken
    assert Drives.lone_command(twins.short.drives) is None
