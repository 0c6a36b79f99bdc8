"""Bodies under gravity, friction and contact, against textbook formulas."""

import math
from pathlib import Path
from typing import Any

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


def _heights(sim: Any, name: str, bottom: float) -> list[float]:
    """The heights of the bounces of a body on the floor in 5 s, m."""
    model, body = sim.world.model, sim.world.game_object(name)
    dof = int(model.body_dofadr[model.body(name).id]) + 2
    heights, speed = [], -1.0
    for _ in range(300):
        sim.step(1)
        z, before = body.world_pose()[0][2] - bottom, speed
        speed = float(sim.world.data.qvel[dof])
        if before > 0.0 >= speed:
            # the apex, within this tick, of the parabola through the positions
            heights.append(z + (speed - 0.5 * 9.81 * model.opt.timestep) ** 2 / (2.0 * 9.81))
    return heights


_SHAPES = {
    "ball": (trimesh.creation.icosphere(subdivisions=3, radius=0.15), 0.15),
    "box": (trimesh.creation.box((0.4, 0.4, 0.2)), 0.1),
    "wheel": (
        trimesh.creation.cylinder(0.2, 0.05).apply_transform(trimesh.geometry.align_vectors([0, 0, 1], [0, 1, 0])),
        0.2,
    ),
}


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.5, 0.7, 0.9])
@pytest.mark.parametrize(
    ("shape", "height", "mass", "steps"),
    [
        ("ball", 1.0, 1.0, 0),
        ("box", 0.6, 40.0, 0),
        ("wheel", 1.37, 0.1, 0),
        ("ball", 2.0, 3.0, 4),
        ("box", 1.0, 1.0, 1),
    ],
)
def test_three_bounces_are_as_high_as_asked(
    tmp_path: Path, ratio: float, shape: str, height: float, mass: float, steps: int
) -> None:
    mesh, bottom = _SHAPES[shape]
    mesh.export(tmp_path / "body.obj")
    text = f"from morse.builder import *\nbody = PassiveObject({str(tmp_path / 'body.obj')!r})\nbody.set_mass({mass})\n"
    text += f"body.translate(1, 0, {bottom + height})\nbody.set_restitution({ratio})\nbody.set_damping(0, 0)\n"
    text += "env = Environment('empty', fastmode=True)\n"
    text += f"env.set_physics_step_sub({steps})\n" if steps else ""
    (tmp_path / "scene.py").write_text(text)
    with morse.load(tmp_path / "scene.py") as sim:
        heights = _heights(sim, "body", bottom)
    wanted = [height * ratio ** (2 * number) for number in (1, 2, 3)]
    # shorter jumps fall between two ticks
    wanted = [one for one in wanted if math.sqrt(2.0 * 9.81 * one) > 2.0 * 9.81 / 60.0]
    assert wanted
    # a floor is a tenth of a millimetre lower or higher for the engine
    assert heights[: len(wanted)] == pytest.approx(wanted, rel=0.005, abs=1e-4)


def test_a_body_without_bounce_stays_down(tmp_path: Path) -> None:
    text = "from morse.builder import *\nbody = Sphere('body')\nbody.set_rigid_body()\nbody.translate(z=2)\n"
    (tmp_path / "scene.py").write_text(text + "body.set_restitution(0)\nenv = Environment('empty', fastmode=True)\n")
    with morse.load(tmp_path / "scene.py") as sim:
        assert max(_heights(sim, "body", 1.0), default=0.0) < 1e-4
        assert sim.world.game_object("body").world_pose()[0][2] == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("ratio", [0.2, 0.8])
def test_a_ball_that_bounces_off_rough_ground_rolls(tmp_path: Path, ratio: float) -> None:
    """The impulse of friction ends the slip, and does not reverse it: of a solid ball, 5/7 of the speed is left."""
    text = "from morse.builder import *\nbody = Sphere('body')\nbody.set_rigid_body()\nbody.translate(z=2)\n"
    text += f"body.set_restitution({ratio})\nbody.set_damping(0, 0)\nbody.set_friction(1)\n"
    (tmp_path / "scene.py").write_text(text + "env = Environment('empty', fastmode=True)\n")
    with morse.load(tmp_path / "scene.py") as sim:
        sim.world.game_object("body").set_velocity((2.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for _ in range(60):
            sim.step(1)
            if sim.world.data.qvel[2] > 0.0:
                break
        speed = sim.world.data.qvel.copy()
    assert speed[0] == pytest.approx(2.0 * 5.0 / 7.0, rel=0.003)
    assert speed[4] == pytest.approx(speed[0] / 1.0, rel=0.005)


@pytest.mark.parametrize("others", ["", "robot = Robot({folder!r} + '/robot.xml')\n"])
def test_balls_exchange_their_speeds(tmp_path: Path, others: str) -> None:
    """Momentum is kept, and the speeds differ by the restitution; also with the pyramids of friction of a file."""
    (tmp_path / "robot.xml").write_text(
        "<mujoco><worldbody><body pos='0 9 1'><freejoint/><geom size='.2'/></body></worldbody></mujoco>"
    )
    text = "from morse.builder import *\n" + others.format(folder=str(tmp_path))
    for name, x, mass in (("one", -1.0, 1.0), ("other", 2.0, 3.0)):
        text += f"{name} = Sphere({name!r})\n{name}.set_rigid_body()\n{name}.translate({x}, 0, 5)\n"
        text += f"{name}.set_mass({mass})\n{name}.set_restitution(0.7)\n{name}.set_damping(0, 0)\n"
    (tmp_path / "scene.py").write_text(text + "env = Environment('empty', fastmode=True)\n")
    with morse.load(tmp_path / "scene.py") as sim:
        sim.world.game_object("one").set_velocity((6.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        sim.step(24)
        model, speeds = sim.world.model, sim.world.data.qvel
        one, other = (float(speeds[model.body_dofadr[model.body(name).id]]) for name in ("one", "other"))
    assert one + 3.0 * other == pytest.approx(6.0, rel=1e-6)
    assert other - one == pytest.approx(0.7 * 6.0, rel=0.002)


def test_bodies_that_bounce_come_to_rest_in_a_heap(tmp_path: Path) -> None:
    text = "from morse.builder import *\n"
    for number in range(4):
        text += f"c{number} = Cube('c{number}')\nc{number}.translate(0.1 * {number}, 0, {1.0 + 2.3 * number})\n"
        text += f"c{number}.set_rigid_body()\nc{number}.set_restitution(0.4)\n"
    (tmp_path / "scene.py").write_text(text + "env = Environment('empty', fastmode=True)\n")
    with morse.load(tmp_path / "scene.py") as sim:
        for _ in range(20):
            sim.step(30)
            if not sim.world.data.nv_awake:
                break
        heights = [sim.world.game_object(f"c{number}").world_pose()[0][2] for number in range(4)]
        assert sim.world.data.nv_awake == 0
    assert heights == pytest.approx([1.0, 3.0, 5.0, 7.0], abs=2e-3)


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
