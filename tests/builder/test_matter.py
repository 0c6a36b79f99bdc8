"""The physics of solids and robots, as scripts set it: the same methods for all."""

import pytest

import morse
from morse import builder

SOLIDS = ("Cube", "Cylinder", "Cone", "Sphere", "IcoSphere", "Torus")


def fall(kind: str, restitution: float | None = None, *, static: bool = False) -> tuple[float, list[float]]:
    """The mass of a solid of 0.2 m that is released at 1 m, and its heights for three seconds."""

    def scene() -> None:
        thing = getattr(builder, kind)("thing")
        thing.scale = (0.2, 0.2, 0.2)
        thing.translate(0, 0, 1.0)
        thing.static() if static else thing.set_rigid_body()
        thing.set_mass(2.5)
        thing.set_damping(0.0, 0.0)
        if restitution is not None:
            thing.set_restitution(restitution)
        builder.Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        thing = sim.world.game_object("thing")
        heights = []
        for _ in range(180):
            sim.step()
            heights.append(thing.world_pose()[0][2])
        return thing.mass, heights


@pytest.mark.parametrize("kind", SOLIDS)
def test_every_solid_falls_and_lies(kind: str) -> None:
    mass, heights = fall(kind)
    assert mass == pytest.approx(2.5)
    # the tube of the ring has a quarter of its radius
    assert heights[-1] == pytest.approx(0.05 if kind == "Torus" else 0.2, abs=2e-3)
    assert fall(kind, static=True)[1][-1] == 1.0


@pytest.mark.parametrize("kind", SOLIDS)
@pytest.mark.parametrize("ratio", [0.5, 0.9])
def test_every_solid_bounces(kind: str, ratio: float) -> None:
    _, heights = fall(kind, ratio)
    rest = 0.05 if kind == "Torus" else 0.2
    low = heights.index(min(heights[:40]))
    drop = 1.0 - rest
    # the second height is that of the drop times the square of the ratio
    assert (max(heights[low : low + 60]) - rest) / drop == pytest.approx(ratio**2, abs=0.1)


def test_a_solid_is_decoration_until_the_script_says_otherwise() -> None:
    def scene() -> None:
        builder.Cube("shelf").translate(0, 0, 3.0)
        ball = builder.Sphere("ball")
        ball.scale = (0.1, 0.1, 0.1)
        ball.translate(0, 0, 5.0)
        ball.set_rigid_body()
        builder.Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        sim.step(180)
        assert sim.world.game_object("ball").world_pose()[0][2] == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize("make", ["Cube('thing')", "ATRV('thing')", "Robot(name='thing')"])
@pytest.mark.parametrize("setting", ["mass=7", "friction=0.1", "restitution=0.8", "physics_type='STATIC'"])
def test_settings_without_effect_are_refused(make: str, setting: str) -> None:
    def scene() -> None:
        eval(f"{make}.properties({setting})", vars(builder))
        builder.Environment("empty")

    name = setting.partition("=")[0]
    with pytest.raises(Exception, match=rf"properties\({name}=...\) has no effect.*use set_"):
        morse.load(scene)


def test_a_robot_bounces() -> None:
    def scene() -> None:
        robot = builder.ATRV("robot")
        robot.translate(z=1.0)
        robot.set_restitution(0.8)
        builder.Environment("empty", fastmode=True)

    with morse.load(scene) as sim:
        robot, heights = sim.world.game_object("robot"), []
        for _ in range(90):
            sim.step()
            heights.append(robot.world_pose()[0][2])
        low = heights.index(min(heights[:40]))
        assert max(heights[low:]) > heights[low] + 0.4
