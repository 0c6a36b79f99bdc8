"""Bodies under gravity, friction and contact, against textbook formulas."""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh
from worlds import bits, box, ground, node, rigid, robot, run, sphere, world

import morse
from morse import builder
from morse.physics.poses.kinematics import Rows
from morse.scene import PhysicsType

G = 9.81


def test_free_fall_follows_the_parabola():
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 10)))
    run(w, 1.0)
    x, y, z = w.game_object("Ball").worldPosition
    assert (x, y) == pytest.approx((0, 0), abs=1e-9)
    # semi-implicit steps of length h end h*v/2 below the parabola
    assert z == pytest.approx(10 - 0.5 * G, abs=G / 240)
    assert w.game_object("Ball").worldLinearVelocity.z == pytest.approx(-G, rel=1e-6)


def test_linear_damping_takes_its_share_each_second():
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 0), linear_damping=0.3), gravity=0)
    w.game_object("Ball").worldLinearVelocity = [2, 0, 0]
    run(w, 1.0)
    assert w.game_object("Ball").worldLinearVelocity.x == pytest.approx(2 * 0.7, rel=2e-3)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_angular_damping_takes_its_share_about_each_axis(axis):
    """The inertias of the brick about its axes differ by a factor of ten."""
    w = world(rigid("Brick", box(0.6, 0.3, 0.1), at=(0, 0, 0), angular_damping=0.1), gravity=0)
    brick = w.game_object("Brick")
    brick.worldAngularVelocity = [float(axis == k) for k in range(3)]
    run(w, 10.0)
    assert brick.worldAngularVelocity[axis] == pytest.approx(0.9**10, rel=5e-3)


def test_a_box_rests_on_the_ground_and_stays():
    w = world(ground(), rigid("Box", box(1, 1, 1), at=(0, 0, 0.5)))
    run(w, 5.0)
    assert tuple(w.game_object("Box").worldPosition) == pytest.approx((0, 0, 0.5), abs=2e-3)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.5])
def test_a_box_slides_down_a_slope_as_friction_lets_it(mu):
    tilt = math.radians(30)
    w = world(
        ground(tilt=tilt), rigid("Box", box(1, 1, 0.2), at=(0.1 * math.sin(tilt), 0, 0.1 * math.cos(tilt)), friction=mu)
    )
    box_object = w.game_object("Box")
    box_object.worldOrientation = [0, tilt, 0]
    start = box_object.worldPosition
    run(w, 1.0)
    expected = 0.5 * G * (math.sin(tilt) - mu * math.cos(tilt))
    assert (box_object.worldPosition - start).length == pytest.approx(expected, rel=0.03, abs=0.01)


def test_friction_holds_a_box_on_a_gentle_slope():
    tilt = math.radians(15)
    w = world(
        ground(tilt=tilt),
        rigid("Box", box(1, 1, 0.2), at=(0.1 * math.sin(tilt), 0, 0.1 * math.cos(tilt)), friction=0.5),
    )
    box_object = w.game_object("Box")
    box_object.worldOrientation = [0, tilt, 0]
    run(w, 2.0)
    assert math.hypot(*box_object.worldPosition[:2]) < 0.03


def test_a_force_accelerates_by_mass():
    w = world(rigid("Box", box(1, 1, 1), at=(0, 0, 0), mass=4.0), gravity=0)
    run(w, 1.0, lambda: w.game_object("Box").applyForce([8, 0, 0]))
    assert w.game_object("Box").worldLinearVelocity.x == pytest.approx(2.0, rel=1e-3)
    assert w.game_object("Box").worldPosition.x == pytest.approx(1.0, rel=1e-2)


def test_a_torque_turns_by_inertia():
    w = world(rigid("Box", box(1, 1, 1), at=(0, 0, 0), mass=6.0), gravity=0)
    run(w, 1.0, lambda: w.game_object("Box").applyTorque([0, 0, 0.5]))
    # a unit cube of 6 kg has 1 kg m^2
    assert w.game_object("Box").worldAngularVelocity.z == pytest.approx(0.5, rel=1e-2)


def test_a_wall_that_moves_after_gravity_was_disabled_stops_a_body():
    wall = node("Wall", box(0.2, 3, 1), at=(5, 0, 0.5))
    # the engine uses its tree of bounding boxes for bodies with several shapes
    posts = [node(f"Post{i}", box(0.2, 0.2, 1), at=(-5, i, 0.5)) for i in range(20)]
    w = world(wall, *posts, rigid("Box", box(0.3, 0.3, 0.3), at=(0, 0, 0.5)))
    w.game_object("Wall").worldPosition = (5, 4, 0.5)
    w.game_object("Box").disable_gravity()
    w.game_object("Wall").worldPosition = (1, 0, 0.5)
    w.game_object("Box").worldLinearVelocity = (1, 0, 0)
    run(w, 2.0)
    assert w.game_object("Box").worldPosition.x <= 0.75 + 0.01


def test_weightless_bodies_hover():
    w = world(rigid("A", sphere(0.1), at=(0, 0, 3), gravity=False), rigid("B", sphere(0.1), at=(2, 0, 3)))
    w.game_object("B").disable_gravity()
    run(w, 1.0)
    assert w.game_object("A").worldPosition.z == pytest.approx(3, abs=1e-6)
    assert w.game_object("B").worldPosition.z == pytest.approx(3, abs=1e-6)


def test_momentum_is_conserved_when_balls_meet():
    w = world(
        rigid("A", sphere(0.1), at=(-1, 0, 0), mass=2.0, friction=0.0),
        rigid("B", sphere(0.1), at=(1, 0, 0), mass=1.0, friction=0.0),
        gravity=0,
    )
    a, b = w.game_object("A"), w.game_object("B")
    a.worldLinearVelocity = [1, 0, 0]
    b.worldLinearVelocity = [-1, 0, 0]
    run(w, 2.0)
    assert 2 * a.worldLinearVelocity.x + b.worldLinearVelocity.x == pytest.approx(1.0, abs=1e-6)
    assert a.worldLinearVelocity.x < 1.0 - 0.1


def test_reset_puts_everything_back():
    w = world(ground(), rigid("Ball", sphere(0.1), at=(0, 0, 1)), node("Wall", box(1, 1, 1), at=(5, 0, 0.5)))
    before = bits(w.get_state())
    run(w, 1.0)
    w.game_object("Wall").worldPosition = [7, 0, 0.5]
    w.reset()
    assert bits(w.get_state()) == before
    assert tuple(w.game_object("Ball").worldPosition) == pytest.approx((0, 0, 1))


def test_two_runs_are_equal_to_the_bit():
    def final():
        w = world(ground(), *(rigid(f"Ball{i}", sphere(0.1), at=(0.03 * i, 0, 1 + 0.3 * i)) for i in range(6)), robot())
        run(w, 2.0, lambda: w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0.3), ground=True))
        return bits(w.get_state())

    assert final() == final()


# -- bodies that cannot move along some axes, and robots that only commands turn -------------------


def test_a_body_moves_along_its_free_axes_only():
    w = world(rigid("Bead", sphere(0.1), at=(0, 0, 1), lock_location=(False, True, True)))
    run(w, 1.0, lambda: w.game_object("Bead").applyForce([2, 3, 4]))
    x, y, z = w.game_object("Bead").worldPosition
    assert x == pytest.approx(1.0, rel=0.02)
    assert (y, z) == (0, 1)


def test_a_body_that_may_not_turn_slides_upright():
    w = world(ground(), rigid("Pole", box(0.2, 0.2, 2), at=(0, 0, 1), lock_rotation=(True, True, True), friction=0.0))
    pole = w.game_object("Pole")
    pole.worldLinearVelocity = [1, 0, 0]
    run(w, 1.0, lambda: pole.applyTorque([50, 50, 50]))
    assert tuple(pole.worldOrientation.to_euler()) == pytest.approx((0, 0, 0), abs=1e-9)
    assert pole.worldPosition.x == pytest.approx(1.0, rel=0.02)


def test_a_locked_body_can_be_put_elsewhere():
    w = world(rigid("Bead", sphere(0.1), at=(0, 0, 1), lock_location=(True, True, True)))
    w.game_object("Bead").worldPosition = [2, 3, 4]
    run(w, 0.5)
    assert tuple(w.game_object("Bead").worldPosition) == pytest.approx((2, 3, 4))


def test_a_dynamic_robot_is_not_toppled_but_obeys():
    made = {}
    for kind in (PhysicsType.RIGID_BODY, PhysicsType.DYNAMIC):
        body = robot(shape=box(0.4, 0.4, 1.6), at=(0, 0, 0.8))
        body.body.type = kind
        w = world(ground(), body, robots=[body])
        obj = w.game_object("robot")
        run(w, 1.0, lambda obj=obj: obj.applyTorque([0, 80, 0]))
        made[kind] = obj.worldOrientation[2][2]
        run(w, 1.0, lambda obj=obj: obj.drive((0, 0, 0), (0, 0, 0.5), ground=True))
        if kind is PhysicsType.DYNAMIC:
            assert obj.worldOrientation.to_euler().z == pytest.approx(0.5, abs=0.02)
    assert made[PhysicsType.DYNAMIC] == pytest.approx(1.0, abs=1e-4)
    assert made[PhysicsType.RIGID_BODY] < math.cos(0.2)


# -- pulling a body at a point, like the pointer in the view ---------------------------------------

STIFFNESS, DAMPING, STRONGEST = 60.0, 2 * math.sqrt(60.0), 80.0


def pull(w, name, anchor, target):
    w.game_object(name).pull(anchor, target, STIFFNESS, DAMPING, STRONGEST)


def test_a_weightless_body_ends_where_it_is_pulled_to():
    w = world(rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0), mass=7.0), gravity=0)
    run(w, 2.0, lambda: pull(w, "Box", (0, 0, 0), (1, 0.5, 0)))
    assert tuple(w.game_object("Box").worldPosition) == pytest.approx((1, 0.5, 0), abs=0.01)


def test_under_gravity_it_hangs_below_the_pointer():
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0.25), mass=7.0))
    run(w, 3.0, lambda: pull(w, "Box", (0, 0, 0), (0, 0, 2.0)))
    # the spring is stretched by g/k
    assert w.game_object("Box").worldPosition.z == pytest.approx(2.0 - 9.81 / STIFFNESS, abs=0.02)


def test_the_pull_has_a_limit():
    w = world(rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0)), gravity=0)
    pull(w, "Box", (0, 0, 0), (1e6, 0, 0))
    w.step()
    assert w.game_object("Box").worldLinearVelocity.x == pytest.approx(STRONGEST / 60, rel=0.02)


def test_what_stands_fast_is_not_pulled():
    w = world(node("Wall", box(1, 1, 1), at=(0, 0, 0.5)))
    run(w, 0.5, lambda: pull(w, "Wall", (0, 0, 0), (5, 0, 0)))
    assert tuple(w.game_object("Wall").worldPosition) == pytest.approx((0, 0, 0.5))


def test_centres_of_mass_are_in_the_frame_of_the_body():
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(3, 0, 0.25), mass=7.0))
    assert w.mass_centres() == [("Box", pytest.approx(7.0), pytest.approx((0, 0, 0)))]


# -- objects that slide ----------------------------------------------------------------------------

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


# -- bodies bounce as scripts say, and slide with the friction that scripts set, on any ground -----

SLOPE = """
<mujoco><worldbody>
  <geom name="ground" type="plane" size="50 50 1" euler="0 {angle} 0" friction="1"/>
</worldbody></mujoco>
"""


def _heights(tmp_path: Path, restitution: float, mesh: trimesh.Trimesh, height: float, bottom: float) -> list[float]:
    """The heights of the bounces of a body on the floor, m."""
    mesh.export(tmp_path / "body.obj")
    text = f"from morse.builder import *\nbody = PassiveObject({str(tmp_path / 'body.obj')!r})\n"
    text += f"body.translate(1, 0, {bottom + height})\nbody.set_restitution({restitution})\nbody.set_damping(0, 0)\n"
    (tmp_path / "scene.py").write_text(text + "env = Environment('empty', fastmode=True)\n")
    heights, speed = [], -1.0
    with morse.load(tmp_path / "scene.py") as sim:
        body = sim.world.game_object("body")
        for _ in range(300):
            sim.step(1)
            z, before = body.world_pose()[0][2] - bottom, speed
            speed = float(sim.world.data.qvel[2])
            if before > 0.0 >= speed:
                # the apex, within this tick
                heights.append(z + speed**2 / (2.0 * 9.81))
    return heights


def _rebound(tmp_path: Path, restitution: float, mesh: trimesh.Trimesh, height: float, bottom: float) -> float:
    """The ratio of the speeds after and before the impact of a body on the floor."""
    heights = _heights(tmp_path, restitution, mesh, height, bottom)
    return math.sqrt(max(heights[0], 0.0) / height) if heights else 0.0


@pytest.mark.parametrize("restitution", [0.0, 0.2, 0.3, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("height", [0.6, 1.0, 1.37])
def test_balls_bounce_as_asked(tmp_path: Path, restitution: float, height: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    assert _rebound(tmp_path, restitution, ball, height, 0.15) == pytest.approx(restitution, abs=0.05)


@pytest.mark.parametrize("restitution", [0.7, 0.8, 0.9])
@pytest.mark.parametrize("height", [0.5, 1.0])
def test_three_bounces_are_as_high_as_asked(tmp_path: Path, restitution: float, height: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    heights = _heights(tmp_path, restitution, ball, height, 0.15)
    for number, reached in enumerate(heights[:3], 1):
        assert (reached / height) ** (0.5 / number) == pytest.approx(restitution, rel=0.008)


def test_a_box_of_another_mass_bounces_as_asked(tmp_path: Path) -> None:
    assert _rebound(tmp_path, 0.6, trimesh.creation.box((0.4, 0.4, 0.2)), 1.0, 0.1) == pytest.approx(0.6, abs=0.05)


@pytest.mark.parametrize(("angle", "friction"), [(28, 0.3), (36, 0.3), (36, 0.9)])
def test_the_friction_of_a_script_holds_on_the_ground_of_a_file(tmp_path: Path, angle: float, friction: float) -> None:
    (tmp_path / "slope.xml").write_text(SLOPE.format(angle=angle))
    trimesh.creation.box((0.4, 0.4, 0.1)).export(tmp_path / "block.obj")
    text = f"""
from morse.builder import *
block = PassiveObject({str(tmp_path / "block.obj")!r})
block.translate(0, 0, {0.051 / math.cos(math.radians(angle))})
block.rotate(0, {math.radians(angle)}, 0)
block.set_friction({friction})
block.set_damping(0, 0)
env = Environment({str(tmp_path / "slope.xml")!r}, fastmode=True)
"""
    (tmp_path / "scene.py").write_text(text)
    with morse.load(tmp_path / "scene.py") as sim:
        block = sim.world.game_object("block")
        sim.step(30)
        start = block.world_pose()[0]
        sim.step(60)
        path = math.dist(block.world_pose()[0], start)
    slope = math.radians(angle)
    acceleration = max(9.81 * (math.sin(slope) - friction * math.cos(slope)), 0.0)
    # from 0.5 s to 1.5 s
    assert path == pytest.approx(0.5 * acceleration * (1.5**2 - 0.5**2), rel=0.05, abs=0.01)


# -- rows of poses: what was shared never changes --------------------------------------------------


@pytest.mark.parametrize("count", [3, 20_000], ids=["small", "too large for copies in advance"])
def test_shared_arrays_keep_their_values(count: int) -> None:
    rows = Rows(np.zeros((count, 3)), 2)
    shared = []
    for tick in range(150):
        rows.take(np.full((2, 3), float(tick)))
        if tick == 100:
            rows[2] = (7.0, 8.0, 9.0)
        if tick % 3:
            shared.append((tick, rows.share()))
    for tick, array in shared:
        assert array.shape == (count, 3)
        assert np.all(array[:2] == tick)
        assert array[2].tolist() == ([7.0, 8.0, 9.0] if tick >= 100 else [0.0, 0.0, 0.0])
    assert [*rows[1]] == [149.0] * 3
