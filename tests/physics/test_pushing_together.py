"""Robots that push something are driven in one pass, exactly like robots that are driven one by one."""

import pytest
from worlds import bits, box, ground, node, rigid, robot, world

COUNT = 4


def pushers(obstacle):
    bodies = [robot(f"robot{i}", at=(0, 1.5 * i, 0.25)) for i in range(COUNT)]
    others = [obstacle(i) for i in range(COUNT)]
    return world(ground(), *bodies, *others, robots=bodies)


def crate(i):
    return rigid(f"crate{i}", box(0.4, 0.4, 0.4), at=(0.5, 1.5 * i + 0.05, 0.2), mass=3.0)


def post(i):
    return node(f"post{i}", box(0.4, 0.4, 0.8), at=(0.5, 1.5 * i, 0.4))


class Pair:
    """The same world twice: robots of one are driven as a fleet, those of the other one by one."""

    def __init__(self, obstacle):
        self.together, self.alone = pushers(obstacle), pushers(obstacle)
        self.fleet = self.together.fleet([self.together.game_object(f"robot{i}") for i in range(COUNT)])
        self.single = []
        self.lasting = None
        drive = self.together.drives._drive_body
        self.together.drives._drive_body = lambda *arguments: self.single.append(1) or drive(*arguments)

    def tick(self, v, w, position, grounded):
        if (v, w, position, grounded) != self.lasting:
            self.lasting = v, w, position, grounded
            for i in range(COUNT):
                self.together.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, w), position=position, ground=grounded)
                assert self.fleet.adopt(i)
        self.fleet.drive()
        for i in range(COUNT):
            self.alone.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, w), position=position, ground=grounded)
        for each in (self.together, self.alone):
            each.step()

    def are_equal(self):
        return bits(self.together.get_state()) == bits(self.alone.get_state())

    def travelled(self, name):
        return float(self.together.game_object(name).worldPosition.x)


@pytest.mark.parametrize("grounded", [True, False])
@pytest.mark.parametrize("position", [True, False])
def test_crates_are_pushed_alike(position, grounded):
    pair = Pair(crate)
    for k in range(60):
        # they start, go straight, turn, and stop
        v, w = (0.5, 0.0 if k < 30 else 0.4) if k < 50 else (0.0, 0.0)
        pair.tick(v, w, position, grounded)
        assert pair.are_equal(), k
    for i in range(COUNT):
        assert pair.travelled(f"crate{i}") > 0.6


def test_only_robots_that_start_or_stop_are_driven_one_by_one():
    pair = Pair(crate)
    for _ in range(3):
        pair.tick(0.5, 0.0, False, True)
    assert len(pair.single) == COUNT
    for k in range(60):
        pair.tick(0.5 + 0.001 * k, 0.1, False, True)
    assert not pair.together.gliding.glides
    assert len(pair.single) == COUNT
    for _ in range(2):
        pair.tick(0.0, 0.0, False, True)
    assert len(pair.single) == 2 * COUNT


def test_robots_that_stand_still_against_a_wall_do_not_glide_and_do_not_enter_it():
    pair = Pair(post)
    for _ in range(90):
        pair.tick(0.3, 0.0, True, True)
    assert pair.are_equal()
    assert not pair.together.gliding.glides
    for i in range(COUNT):
        # the front of a robot is 0.25 m ahead of its origin, the post begins at 0.3 m
        assert pair.travelled(f"robot{i}") == pytest.approx(0.05, abs=0.02)


def test_robots_that_are_free_again_glide():
    pair = Pair(post)
    for _ in range(60):
        pair.tick(0.3, 0.0, False, True)
    for _ in range(60):
        pair.tick(-0.3, 0.0, False, True)
    assert pair.are_equal()
    assert len(pair.together.gliding.glides) == COUNT
