"""Deformable bodies of MJCF files: they move as in MuJoCo, are seen in pictures, restored and replayed."""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import morse
from morse.assets.errors import AssetError
from morse.assets.mjcf import read_mjcf
from morse.core.exceptions import MorseBuilderError
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.rendering.contents import Contents, MeshStore
from morse.rendering.lens import moved
from morse.rendering.renderer import photograph
from morse.rendering.textures import TextureStore
from tests.kit.waiting import wait_until

CLOTH = """<flexcomp name="cloth" type="grid" count="7 7 1" spacing=".1 .1 .1" pos="0 0 1" radius=".01" mass="1"
  dim="2" rgba="0 1 0 1"><edge equality="true" damping="0.01"/><contact selfcollide="none"/></flexcomp>"""
JELLY = """<flexcomp name="jelly" type="grid" count="3 3 3" spacing=".1 .1 .1" pos="1.5 0 .6" radius=".005" mass="5"
  dim="3" rgba="1 0 0 1"><elasticity young="1e4" poisson=".1" damping=".02"/><contact selfcollide="none"/></flexcomp>"""
TRILINEAR = """<flexcomp name="block" type="grid" count="4 4 4" spacing=".05 .05 .05" pos="-1.5 0 .6" radius=".005"
  mass="2" dim="3" dof="trilinear"><elasticity young="1e4" poisson=".1" damping=".01"/>
  <contact selfcollide="none"/></flexcomp>"""
ROPE = """<flexcomp name="rope" type="grid" count="12 1 1" spacing=".05 .05 .05" pos="0 1 1" radius=".02" mass="1"
  dim="1" rgba="0 0 1 1"><pin id="0"/><edge equality="true" damping=".1"/></flexcomp>"""
BALL = '<body name="ball" pos="0 0 .3"><geom name="ball" type="sphere" size=".2"/></body>'
ALL = CLOTH + JELLY + TRILINEAR + ROPE
STEP = 0.001


def written(folder: Path, parts: str, step: float = STEP, more: str = "") -> Path:
    path = folder / "soft.xml"
    path.write_text(
        f'<mujoco model="soft"><option timestep="{step}"/><worldbody><geom name="floor" type="plane" size="0 0 .1"/>'
        f"{BALL}{parts}</worldbody>{more}</mujoco>"
    )
    return path


@pytest.fixture
def scene(tmp_path: Path) -> Callable[..., Callable[[], None]]:
    """A script with a robot of a file that has some deformable bodies."""

    def make(parts: str = ALL, step: float = STEP) -> Callable[[], None]:
        path = written(tmp_path, parts, step)

        def script() -> None:
            from morse.builder import Environment, Robot

            Robot(str(path))
            view = Environment("empty", fastmode=True)
            view.set_camera_location([0.0, -4.0, 1.5])
            view.set_camera_rotation([1.35, 0.0, 0.0])

        return script

    return make


def empty() -> None:
    from morse.builder import Environment

    Environment("empty", fastmode=True)


def vertices(world: Any, name: str) -> np.ndarray:
    node = world.game_object(name).node
    return np.array([world.object_of(child).world_pose()[0] for child in node.children])


def alone(path: Path, seconds: float) -> dict[str, np.ndarray]:
    """The vertices in MuJoCo alone."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(seconds / model.opt.timestep))
    mujoco.mj_kinematics(model, data)
    mujoco.mj_flex(model, data)
    return {
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_FLEX, number): data.flexvert_xpos[first : first + count].copy()
        for number, (first, count) in enumerate(zip(model.flex_vertadr, model.flex_vertnum, strict=True))
    }


def test_they_move_as_in_mujoco(scene: Callable[..., Any], tmp_path: Path) -> None:
    # 17 steps of a tick are 1/60 s: MuJoCo alone has the same step
    with morse.load(scene()) as sim:
        sim.step(30)
        found = {name: vertices(sim.world, name) for name in ("cloth", "jelly", "block", "rope")}
    expected = alone(written(tmp_path, ALL, 1.0 / 60 / 17), 0.5)
    for name, points in found.items():
        assert points.shape == expected[name].shape
        assert np.abs(points - expected[name]).max() < 1e-6, name


def test_a_cloth_lies_on_a_ball_and_touches_it(scene: Callable[..., Any]) -> None:
    with morse.load(scene(CLOTH)) as sim:
        sim.step(60)
        points = vertices(sim.world, "cloth")
        assert points[24] == pytest.approx([0.0, 0.0, 0.51], abs=0.02)  # its middle, above the ball of 0.2 m
        assert points[[0, 6, 42, 48], 2].max() < 0.4  # its corners hang
        pairs = {frozenset((a.name, b.name)) for a, b in sim.world.contacts()}
        assert frozenset(("ball_shape", "cloth")) in pairs
        assert sim.world.game_object("cloth").world_pose()[0] == pytest.approx(tuple(points.mean(axis=0)))


def colored(image: np.ndarray, channel: int) -> np.ndarray:
    """The rows of the pixels of one colour."""
    others = [number for number in range(3) if number != channel]
    return np.argwhere(image[..., channel] > 60 + image[..., others].max(axis=2).astype(int))[:, 0]


def test_pictures_show_them_where_they_are(scene: Callable[..., Any]) -> None:
    with morse.load(scene(CLOTH + JELLY + ROPE)) as sim:
        before = photograph(sim.world, 320, 200)
        sim.step(60)
        after = photograph(sim.world, 320, 200)
    for channel, fall in ((0, 10), (1, 20)):
        assert len(colored(before, channel)) > 60
        assert len(colored(after, channel)) > 60
        assert colored(after, channel).mean() - colored(before, channel).mean() > fall
    # a cloth that hangs over a ball is higher in the picture than one that is seen from its side
    assert np.ptp(colored(after, 1)) > 1.5 * np.ptp(colored(before, 1))
    assert len(colored(before, 2)) > 15


def test_shadows_follow_their_shape(scene: Callable[..., Any]) -> None:
    """A cloth that only changes its shape, while its mean stays, has another shadow."""
    with morse.load(scene(CLOTH)) as sim:
        world = sim.world
        one = photograph(world, 200, 120)
        data = world.data
        slot = world.slots[world.slot_of[world.game_object("cloth").node]]
        points = data.qpos[slot.qpos : slot.qpos + slot.soft].reshape(-1, 3)
        points[:, 0] += 0.2 * np.where(np.arange(len(points)) % 2, 1.0, -1.0) * (np.arange(len(points)) != 48)
        world.sync()
        kept = world.game_object("cloth").world_pose()[0]
        assert kept == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)
        other = photograph(world, 200, 120)
        assert np.array_equal(other, photograph(world, 200, 120))
    assert (one != other).any(axis=2).sum() > 50


def test_states_are_restored(scene: Callable[..., Any]) -> None:
    with morse.load(scene()) as sim:
        sim.step(20)
        state, before = sim.save(), vertices(sim.world, "cloth")
        sim.step(20)
        later = vertices(sim.world, "cloth")
        sim.restore(state)
        assert np.array_equal(vertices(sim.world, "cloth"), before)
        sim.step(20)
        assert np.array_equal(vertices(sim.world, "cloth"), later)


def test_they_keep_their_shape_when_the_scene_changes(scene: Callable[..., Any]) -> None:
    with morse.load(scene()) as sim:
        sim.step(30)
        before = vertices(sim.world, "cloth")
        sim.spawn("table", "props/crates", (4.0, 0.0, 0.5))
        assert np.abs(vertices(sim.world, "cloth") - before).max() < 1e-9


def test_clients_spawn_small_ones_only(tmp_path: Path) -> None:
    text = written(tmp_path, CLOTH).read_text()
    with morse.load(empty) as sim:
        sim.population.spawn("small", text, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), by_client=True)
        sim.step(3)
        (cloth,) = [obj.name for obj in sim.world.objects() if obj.node.flex is not None]
        assert len(vertices(sim.world, cloth)) == 49
        large = text.replace("7 7 1", "40 40 1")
        with pytest.raises(MorseBuilderError, match="1600 vertices of deformable bodies, and clients may spawn 1000"):
            sim.population.spawn("large", large, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), by_client=True)
        sim.step()


def test_recordings_show_them(scene: Callable[..., Any], tmp_path: Path) -> None:
    with morse.load(scene(CLOTH)) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(40)
        truth = vertices(sim.world, "cloth")
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as shown:
        shown.announce()
        wait_until(lambda: shown.turn() or shown._timeline.position == 40, "the end of the run")  # type: ignore[func-returns-value]
        assert np.abs(vertices(shown._simulation.world, "cloth") - truth).max() < 1e-6
        assert photograph(shown._simulation.world, 80, 50).any()


def test_robots_drive_beside_elastic_bodies(tmp_path: Path) -> None:
    path = written(tmp_path, JELLY)

    def script() -> None:
        from morse.builder import ATRV, Environment, MotionVW, PassiveObject

        PassiveObject(str(path))
        robot = ATRV("robot")
        robot.translate(x=-4)
        robot.append(MotionVW("motion"))
        Environment("empty", fastmode=True)

    with morse.load(script) as sim:
        sim["robot"].motion.publish({"v": 1.0})
        sim.step(60)
        assert sim.world.game_object("robot").world_pose()[0][0] == pytest.approx(-3.0, abs=0.03)
        assert vertices(sim.world, "jelly")[:, 2].min() == pytest.approx(0.005, abs=0.01)
        assert sim.failures == ()


def test_a_batch_has_the_shapes_of_single_simulations(scene: Callable[..., Any]) -> None:
    with morse.load(scene(CLOTH)) as sim:
        sim.step(20)
        expected = vertices(sim.world, "cloth")
    with morse.batch(scene(CLOTH), 2) as batch:
        batch.step(20)
        for row in range(2):
            assert np.array_equal(vertices(batch[row].world, "cloth"), expected)


def test_one_that_diverges_is_named(scene: Callable[..., Any]) -> None:
    stiff = JELLY.replace("1e4", "1e8")
    with morse.load(scene(stiff)) as sim, pytest.raises(Exception, match="jelly"):
        sim.step(60)


SQUARE = "v 0 0 0\nv .3 0 0\nv 0 .3 0\nv .3 .3 0\nv .15 .15 .02\n"
FANS = {"obj": SQUARE + "f 1 2 5\nf 2/1/1 4 5\nf -2 -3 -1\nf 3 1 5\n", "polygon": SQUARE + "f 1 2 4 3\n"}


def stl(triangles: list[list[tuple[float, ...]]]) -> bytes:
    """A binary file."""
    rows = b"".join(np.array([(0, 0, 1), *one], "<f4").tobytes() + b"\0\0" for one in triangles)
    return bytes(80) + len(triangles).to_bytes(4, "little") + rows


@pytest.mark.parametrize("form", ["obj", "polygon", "stl", "ascii.stl"])
def test_cloths_of_mesh_files_have_the_vertices_in_their_order(tmp_path: Path, form: str) -> None:
    corners = [[(0, 0, 0), (0.3, 0, 0), (0.3, 0.3, 0)], [(0, 0, 0), (0.3, 0.3, 0), (0, 0.3, 0)]]
    name = f"cloth.{form.rpartition('.')[2]}" if form != "polygon" else "cloth.obj"
    text = "solid a\n" + "".join(
        f"facet normal 0 0 1\nouter loop\n{' '.join(f'vertex {x} {y} {z}' for x, y, z in each)}\nendloop\nendfacet\n"
        for each in corners
    )
    content = {"stl": stl(corners), "ascii.stl": f"{text}endsolid a\n".encode()}.get(form)  # type: ignore[arg-type]
    (tmp_path / name).write_bytes(content or FANS[form].encode())
    part = (
        f'<flexcomp name="cloth" type="mesh" file="{name}" pos="0 0 1" radius=".005" mass="1" dim="2">'
        '<edge equality="true" damping=".01"/><pin id="0 1"/><contact selfcollide="none"/></flexcomp>'
    )
    path = written(tmp_path, part, 1.0 / 60 / 17)

    def script() -> None:
        from morse.builder import Environment, Robot

        Robot(str(path))
        Environment("empty", fastmode=True)

    with morse.load(script) as sim:
        sim.step(12)
        found = vertices(sim.world, "cloth")
    if form in ("polygon", "ascii.stl"):
        # MuJoCo divides polygons elsewhere, and reads no text
        assert len(found) == 4
        assert np.array_equal(found[:2], [[0.0, 0.0, 1.0], [0.3, 0.0, 1.0]])
        assert found[2, 2] < 0.9
        return
    folder = Path.cwd()
    os.chdir(tmp_path)
    try:
        expected = alone(path, 0.2)["cloth"]
    finally:
        os.chdir(folder)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < 1e-6


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (CLOTH.replace("7 7 1", "2000 2000 1"), "more than 10000 vertices"),
        (CLOTH.replace("7 7 1", "80 80 1"), "more than 5000 moving vertices"),
        (CLOTH.replace("7 7 1", "1e300 1e300 1"), "realistic"),
        (CLOTH.replace("7 7 1", "-5 7 1"), "the engine refuses it"),
        (f'<replicate count="500">{CLOTH}</replicate>', "more than 10000 vertices"),
        ('<flexcomp name="f" type="mesh" file="../../../etc/passwd" dim="2" mass="1"/>', "left out"),
        ('<flexcomp name="f" type="gmsh" file="none.msh" dim="3" mass="1"/>', "left out"),
        ('<flexcomp name="f" type="mesh" dim="2" mass="1"/>', "names no file"),
        ('<flexcomp name="f" type="direct" dim="2" mass="1" point="0 0 0 1 0 0 0 1 0" element="0 1 7"/>', "refuses"),
    ],
)
def test_damaged_ones_are_refused_or_left_out(tmp_path: Path, part: str, words: str) -> None:
    path = written(tmp_path, part)
    told = ""
    with suppress(AssetError):
        library = read_mjcf(path)
        told = "; ".join(library.warnings)
        assert not any(node.flex is not None for root in library.roots for node in root.walk())
    if not told:
        with pytest.raises(AssetError) as refused:
            read_mjcf(path)
        told = str(refused.value)
    assert words in told


def test_what_names_one_that_is_left_out_goes_with_it(tmp_path: Path) -> None:
    lost = '<flexcomp name="f" type="gmsh" file="none.msh" dim="3" mass="1"/>'
    more = '<equality><flex flex="f"/></equality><keyframe><key qpos="1 2 3"/></keyframe>'
    library = read_mjcf(written(tmp_path, lost + CLOTH, more=more))
    assert library.robot or library.roots


def test_damaged_files_of_tetrahedra_never_end_the_process(tmp_path: Path) -> None:
    good = (
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 4 1 4\n"
        "3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
        "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"
    )
    part = '<flexcomp name="f" type="gmsh" file="f.msh" dim="3" radius="0.01" mass="1"/>'
    path = written(tmp_path, part)
    (tmp_path / "f.msh").write_text(good)
    shown = [node.flex for root in read_mjcf(path).roots for node in root.walk() if node.flex is not None]
    assert [len(one) for one in shown] == [4]
    words = good.split(" ")
    for number in range(len(words)):
        for value in ("-1", "999999999", "18446744073709551615", "nan"):
            damaged = list(words)
            damaged[number] = value
            (tmp_path / "f.msh").write_text(" ".join(damaged))
            with suppress(AssetError):
                read_mjcf(path)


def test_rays_hit_them_where_the_engine_says(scene: Callable[..., Any]) -> None:
    """`mujoco.mj_rayFlex` is the measure: the triangles of cloths and volumes, the capsules of ropes."""
    ways = np.random.default_rng(3).normal(size=(300, 3))
    with morse.load(scene()) as sim:
        sim.step(15)
        world, model, data = sim.world, sim.world.model, sim.world.data
        numbers = {
            mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_FLEX, n).rpartition("/")[2]: n for n in range(model.nflex)
        }
        for name, place in (("cloth", (0.1, 0.2, 0.4)), ("jelly", (1.45, -0.35, 0.4)), ("rope", (0.2, 0.9, 0.9))):
            bundle = world.rays.bundle(world.game_object("Ground"), ways, 5.0, np.tile(place, (len(ways), 1)))
            bundle.refresh()
            ground = np.array(world.game_object("Ground").world_pose()[0])
            seen = [n for n in range(len(ways)) if bundle.hit[n] >= 0 and bundle.object_of(n).name == name]
            assert len(seen) > 8, (name, len(seen))
            for n in seen:
                expected = mujoco.mj_rayFlex(
                    *(model, data, 0, False, name == "rope", name != "rope", name == "jelly", numbers[name]),
                    *(ground + place, bundle.directions[n]),
                )
                assert bundle.normals[n] @ bundle.directions[n] < 0.0
                # the engine adds the radius to volumes, and its ropes are round
                if name == "cloth" or expected >= 0.0:
                    exact = 1e-6 if name == "cloth" else 0.02
                    assert bundle.distances[n] == pytest.approx(expected, abs=exact), name


def test_the_velocity_of_what_rays_hit_is_that_of_the_vertices(scene: Callable[..., Any]) -> None:
    """A cloth that falls freely for 0.2 s has 1.96 m/s, and the block whose vertices follow nodes too."""
    with morse.load(scene(CLOTH.replace('pos="0 0 1"', 'pos="0 0 3"') + TRILINEAR)) as sim:
        sim.step(12)
        world = sim.world
        for name, x, z in (("cloth", 0.0, 5.0), ("block", -1.5, 3.0)):
            bundle = world.rays.bundle(world.game_object("Ground"), [(0.0, 0.0, -1.0)], 9.0, [(x + 0.02, 0.01, z)])
            bundle.refresh()
            assert bundle.object_of(0).name == name
            assert bundle.velocities[0] == pytest.approx((0.0, 0.0, -9.81 * 0.2), abs=0.01)


def test_a_scanner_measures_the_distance_of_a_hanging_cloth(tmp_path: Path) -> None:
    curtain = """<body name="rod" euler="0 90 0" pos="2 0 1"><flexcomp name="cloth" type="grid" count="5 9 1"
      spacing=".1 .1 .1" radius=".01" mass="1" dim="2"><edge equality="true"/>
      <pin grid="0 0 0 8 2 8 4 8"/></flexcomp></body>"""
    path = written(tmp_path, curtain)

    def script() -> None:
        from morse.builder import ATRV, Environment, Infrared, PassiveObject

        PassiveObject(str(path))
        robot = ATRV("robot")
        robot.set_physics_type("STATIC")
        infrared = Infrared("infrared")
        infrared.translate(z=1.0)
        infrared.properties(laser_range=5.0)
        robot.append(infrared)
        Environment("empty", fastmode=True)

    with morse.load(script) as sim:
        place = sim["robot"].infrared
        sim.step(2)
        assert min(place.get()["range_list"]) == pytest.approx(2.0, abs=0.02)


def test_cameras_with_an_exposure_know_how_their_vertices_move(scene: Callable[..., Any]) -> None:
    """A cloth that falls freely for 0.2 s, as it was and will be a moment before and after the picture."""
    with morse.load(scene(CLOTH.replace('pos="0 0 1"', 'pos="0 0 3"'))) as sim:
        sim.step(12)
        contents = Contents(sim.world, MeshStore(), TextureStore())
        (flex,) = contents.scenery.flexes
        frames = contents.frames(moving=True)
        now = flex.points(frames.positions)
        later = flex.points(moved(frames.positions, frames.rotations, *frames.velocities, 0.01)[0])
        assert later - now == pytest.approx(np.tile([0.0, 0.0, -9.81 * 0.2 * 0.01], (len(now), 1)), abs=1e-4)
