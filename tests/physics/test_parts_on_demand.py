"""Parts that move within a body: their poses are computed when they are read, their shapes move at once."""

import math

import pytest
from worlds import box, node, robot, world

from morse.scene import Node


def crane(name, y):
    """A robot with a mast that carries a boom that carries a hook, which has a shape."""
    body = robot(name, at=(0, y, 0.25))
    mast = Node(f"{name}_mast", location=[0.1, 0, 0.25])
    boom = Node(f"{name}_boom", location=[0.5, 0, 0.2])
    hook = node(f"{name}_hook", box(0.1, 0.1, 0.1), at=(0.3, 0, 0))
    body.attach(mast)
    mast.attach(boom)
    boom.attach(hook)
    return body


@pytest.fixture
def cranes():
    bodies = [crane("read", 0.0), crane("unread", 3.0)]
    return world(*bodies, robots=bodies, gravity=0.0)


def turn(world, name, angle):
    c, s = math.cos(angle), math.sin(angle)
    mast = world.game_object(f"{name}_mast")
    mast.set_local_pose(mast.local_pose()[0], (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))


def test_reading_in_between_changes_nothing(cranes):
    parts = ("mast", "boom", "hook")
    for k in range(50):
        for name in ("read", "unread"):
            turn(cranes, name, 0.1 * k)
        for part in parts:
            cranes.game_object(f"read_{part}").world_pose()
        cranes.step()
    for part in parts:
        read, unread = cranes.game_object(f"read_{part}"), cranes.game_object(f"unread_{part}")
        assert read.offset == unread.offset
        (x, y, z), turned = unread.world_pose()
        assert (x, y - 3.0, z) == pytest.approx(tuple(read.world_pose()[0]), abs=1e-12)
        assert turned == pytest.approx(read.world_pose()[1], abs=1e-12)


def test_the_shape_of_an_outer_part_moves_although_nobody_reads_it(cranes):
    turn(cranes, "unread", math.pi / 2)
    cranes.step()
    slot = cranes.slots[cranes.game_object("unread_hook").slot]
    (geom,) = slot.geoms[cranes.game_object("unread_hook").node]
    # mast at 0.1 m ahead, boom and hook 0.8 m to its left
    assert cranes.data.geom_xpos[geom] == pytest.approx([0.1, 3.8, 0.7], abs=1e-6)
    assert tuple(cranes.game_object("unread_hook").world_pose()[0]) == pytest.approx((0.1, 3.8, 0.7), abs=1e-6)


def test_a_moved_part_moves_within_a_part_that_moves(cranes):
    boom = cranes.game_object("unread_boom")
    turn(cranes, "unread", math.pi / 2)
    boom.set_local_pose((1.0, 0.0, 0.0), boom.local_pose()[1])
    turn(cranes, "unread", math.pi)
    assert tuple(boom.world_pose()[0]) == pytest.approx((-0.9, 3.0, 0.5), abs=1e-9)
    cranes.reset()
    assert tuple(boom.world_pose()[0]) == pytest.approx((0.6, 3.0, 0.7), abs=1e-9)
