"""Objects that slide."""

import math

import pytest

import morse
from morse import builder

GRAVITY = 9.81


def slide(speed: float, friction: float, *, beside: bool = False) -> list[list[float]]:
    """The positions of a flat box that begins to slide, for two seconds; beside a falling ball if so wished."""

    def scene() -> None:
        for name, y in (("box", 0.0), ("ball", 5.0)):
            if name == "ball" and not beside:
                continue
            thing = builder.Cube(name) if name == "box" else builder.Sphere(name)
            thing.scale = (0.2, 0.2, 0.1)
            thing.translate(0, y, 0.1 if name == "box" else 4.0)
            thing.set_rigid_body()
            thing.set_friction(friction)
            thing.set_damping(0.0, 0.0)
        builder.Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        box, path = sim.world.game_object("box"), []
        sim.step(30)
        box.worldLinearVelocity = [speed, 0.0, 0.0]
        for _ in range(120):
            sim.step()
            path.append(list(box.world_pose()[0]))
        return path


@pytest.mark.parametrize(("speed", "friction"), [(1.0, 0.3), (4.0, 0.5), (6.0, 0.9)])
def test_a_box_slides_as_far_as_coulomb_says_and_stays_on_the_floor(speed: float, friction: float) -> None:
    path = slide(speed, friction)
    assert path[-1][0] == pytest.approx(speed**2 / (2.0 * friction * GRAVITY), rel=0.03, abs=0.01)
    assert max(z for _, _, z in path) - 0.1 < 0.015


def test_what_an_object_does_does_not_depend_on_others_that_move() -> None:
    # the solver of the engine rounds otherwise for more bodies
    assert slide(2.0, 0.4, beside=True) == [pytest.approx(place, abs=1e-9) for place in slide(2.0, 0.4)]


def test_a_block_on_a_steep_slope() -> None:
    angle, friction = math.radians(36.0), 0.3

    def scene() -> None:
        ground = builder.Cube("slope")
        ground.scale = (20.0, 20.0, 0.5)
        ground.translate(-0.5 * math.sin(angle), 0.0, 20.0 - 0.5 * math.cos(angle))
        ground.rotate(y=angle)
        ground.static()
        block = builder.Cube("block")
        block.scale = (0.2, 0.2, 0.05)
        block.translate(0.05 * math.sin(angle), 0.0, 20.0 + 0.05 * math.cos(angle))
        block.rotate(y=angle)
        block.set_rigid_body()
        block.set_friction(friction)
        block.set_damping(0.0, 0.0)
        builder.Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        block, ways = sim.world.game_object("block"), []
        start = block.world_pose()[0]
        for _ in range(3):
            sim.step(30)
            ways.append(math.dist(block.world_pose()[0], start))
    expected = GRAVITY * (math.sin(angle) - friction * math.cos(angle))
    assert (ways[2] - 2.0 * ways[1] + ways[0]) / 0.25 == pytest.approx(expected, rel=0.01)
