from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import trimesh

import morse
from morse import builder
from morse.assets import AssetNotFoundError
from morse.builder import (
    Camera,
    Cone,
    Coordsys,
    Cube,
    Cylinder,
    Empty,
    IcoSphere,
    Mesh,
    MorseBuilderError,
    MorseBuilderNoComponentError,
    PassiveObject,
    Plane,
    Sphere,
    Spot,
    Torus,
    Zone,
    workspace,
)
from morse.builder.script import ScriptError
from morse.scene import NodeKind, PhysicsType

np = pytest.importorskip("numpy")


def volume(mesh: Any) -> float:
    """By the divergence theorem; positive only if the triangles face outward."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(float) for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def is_closed(mesh: Any) -> bool:
    edges = {(int(t[i]), int(t[(i + 1) % 3])) for t in mesh.triangles for i in range(3)}
    return len(edges) == 3 * len(mesh.triangles) and all((b, a) in edges for a, b in edges)


@pytest.mark.parametrize(("make", "size", "content"), [
    (Cube, (2, 2, 2), 8.0),
    (Mesh, (2, 2, 2), 8.0),
    (Cylinder, (2, 2, 2), 2 * np.pi),
    (Cone, (2, 2, 2), 2 * np.pi / 3),
    (Sphere, (2, 2, 2), 4 * np.pi / 3),
    (IcoSphere, (2, 2, 2), 4 * np.pi / 3),
    (Torus, (2.5, 2.5, 0.5), 2 * np.pi**2 * 0.25**2),
])  # fmt: skip
def test_bodies_have_their_size_and_volume(make: type[Any], size: tuple[float, ...], content: float) -> None:
    mesh = make().scene_node.mesh
    extent = np.ptp(mesh.vertices, axis=0)
    assert extent == pytest.approx(size, rel=0.06)
    assert is_closed(mesh)
    # a mesh of flat facets has a smaller volume than the round body
    assert content * 0.88 <= volume(mesh) <= content * 1.000001
    if mesh.normals is not None:
        assert np.linalg.norm(mesh.normals, axis=2) == pytest.approx(1.0)


def test_the_plane_faces_up() -> None:
    mesh = Plane().scene_node.mesh
    assert mesh is not None
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx([2, 2, 0])
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_nothing_collides_with_blender_objects() -> None:
    for make in (Cube, Sphere, Cylinder, Cone, Torus, IcoSphere, Plane, Empty, Mesh, Coordsys, Spot, Camera):
        thing = make()
        assert not thing.is_morseable()
        assert {n.body.type for n in thing.scene_node.walk()} == {PhysicsType.NO_COLLISION}


def test_colors_and_names() -> None:
    red, other = Cube("red_box"), Cube()
    red.color(1.0, 0.0, 0.0)
    assert red.name == "red_box"
    assert red._bpy_object.material_slots[0].material.diffuse_color == (1.0, 0.0, 0.0)  # type: ignore[union-attr]
    assert other._bpy_object.material_slots[0].material.diffuse_color != (1.0, 0.0, 0.0)  # type: ignore[union-attr]
    with pytest.raises(ValueError, match="0 to 1"):
        red.color(255, 0, 0)


def test_lamps_cameras_and_axes() -> None:
    assert Spot().scene_node.light.type == "SPOT"  # type: ignore[union-attr]
    assert Spot("sun", lamp_type="SUN").scene_node.light.type == "SUN"  # type: ignore[union-attr]
    with pytest.raises(ValueError, match="POINT, SUN"):
        Spot("x", lamp_type="LASER")
    assert Camera().scene_node.kind is NodeKind.CAMERA
    tips = [n for n in Coordsys("axes").scene_node.walk() if n.name.endswith("_tip")]
    ends = {tuple(round(float(tip.world_matrix()[i][3]), 6) for i in range(3)) for tip in tips}
    assert ends == {(0.9, 0.0, 0.0), (0.0, 0.9, 0.0), (0.0, 0.0, 0.9)}


# --- passive objects -----------------------------------------------------------------------------


def test_one_object_of_a_file() -> None:
    crate = PassiveObject("props/crates", "small_crate")
    assert crate.scene_node.plain_name == "small_crate"
    assert {n.plain_name for n in crate.scene_node.walk()} == {"small_crate", "small_crate_bb", "small_crate_mesh"}
    assert list(crate.location) == [0.0, 0.0, 0.0]
    assert list(crate.rotation_euler) == [0.0, 0.0, 0.0]
    assert crate.scene_node.body.moves
    assert len(workspace.current().roots) == 1


def test_the_pose_of_the_file_may_be_kept() -> None:
    kept = PassiveObject("environments/indoors-1/boxes", "RedBox", keep_pose=True)
    reset = PassiveObject("environments/indoors-1/boxes", "RedBox")
    assert list(kept.location) == pytest.approx([-7.5, 0.0, 0.99], abs=0.02)
    assert list(reset.location) == [0.0, 0.0, 0.0]


def test_all_objects_of_a_file() -> None:
    first = PassiveObject("props/crates")
    names = {root.plain_name for root in workspace.current().roots}
    assert {"small_crate", "large_crate", "transport_box"} <= names
    assert first.scene_node in workspace.current().roots


def test_unknown_objects() -> None:
    with pytest.raises(MorseBuilderNoComponentError, match="did you mean 'small_crate'"):
        PassiveObject("props/crates", "smal_crate")
    with pytest.raises(AssetNotFoundError, match=r"did you mean .*props/crates"):
        PassiveObject("props/crate")
    for bad in (None, 3, ""):
        with pytest.raises((TypeError, ValueError), match="filename"):
            PassiveObject(bad)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="prefix"):
        PassiveObject("props/crates", 3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="keep_pose"):
        PassiveObject("props/crates", "small_crate", keep_pose=None)  # type: ignore[arg-type]


def test_graspable_objects() -> None:
    crate = PassiveObject("props/crates", "small_crate")
    crate.setgraspable()
    assert crate.property_value("Object") is True
    assert crate.property_value("Graspable") is True
    assert crate.property_value("Label") == "small_crate"


def test_copies_do_not_share_their_settings() -> None:
    one, two = PassiveObject("props/crates", "small_crate"), PassiveObject("props/crates", "small_crate")
    one._bpy_object.game.mass = 99.0
    one.properties(Label="mine")
    one.translate(1.0)
    assert two._bpy_object.game.mass != 99.0
    assert two.property_value("Label") != "mine"
    assert list(two.location) == [0.0, 0.0, 0.0]
    first, second = (c.get_child("small_crate_mesh").node.mesh for c in (one, two))  # type: ignore[union-attr]
    assert first is second, "what is large is shared"


# --- zones ---------------------------------------------------------------------------------------


def test_zones(load: Callable[..., Any]) -> None:
    scene = load(
        "from morse.builder import *\n"
        "dock = Zone(type='Charging')\ndock.size = [2, 1, 0.5]\ndock.translate(x=3.0, z=0.5)\n"
        "env = Environment('empty')\n"
    )
    (zone,) = scene.zones
    assert (zone.type, zone.node.name, zone.node.visible) == ("Charging", "dock", False)
    assert zone.node.scale == [2.0, 1.0, 0.5]
    assert zone.node.location == [3.0, 0.0, 0.5]
    assert scene.components == []


def test_zones_follow_the_axes_of_the_world() -> None:
    zone = Zone("Charging")
    assert list(zone.size) == [1.0, 1.0, 1.0]
    with pytest.raises(MorseBuilderError, match="rotated"):
        zone.rotate(z=1.0)
    for bad in ((1, 1, 0), (1, -1, 1), (1, 1), "big", None):
        with pytest.raises((TypeError, ValueError)):
            zone.size = bad  # type: ignore[assignment]
    for kind in (None, 3, ""):
        with pytest.raises((TypeError, ValueError), match="type"):
            Zone(kind)  # type: ignore[arg-type]


# -- the physics of solids and robots, as scripts set it: the same methods for all -----------------

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


# -- scenes with too many triangles are refused before they fill the memory ------------------------

HEAD = "from morse.builder import *\nfrom morse.builder.bpymorse import *\n"
END = "env = Environment('empty')\n"
BODY = "ball = Sphere('ball')\nbox = Cube('box')\n"


def count(scene):
    meshes = {id(n.mesh): n.mesh for root in scene.roots for n in root.walk() if n.mesh is not None}
    return sum(len(mesh.triangles) for mesh in meshes.values())


def test_the_message_names_the_largest_meshes_and_the_limit(load, monkeypatch):
    whole = count(load(HEAD + BODY + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole - 1)
    with pytest.raises(ScriptError) as refusal:
        load(HEAD + BODY + END)
    report = refusal.value.report()
    assert f"the scene has {whole:,} triangles, and the limit is {whole - 1:,}" in " ".join(report.split())
    assert "'ball' (" in report
    assert "Traceback" not in report
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole)
    load(HEAD + BODY + END)


def test_robots_of_one_model_share_its_triangles(load, monkeypatch):
    one = count(load(HEAD + "robot = ATRV()\n" + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", one)
    load(HEAD + "robots = [ATRV(f'robot{n}') for n in range(5)]\n" + END)


def test_deleted_objects_do_not_count(load, monkeypatch):
    whole = count(load(HEAD + BODY + END))
    monkeypatch.setattr(workspace, "MOST_TRIANGLES", whole)
    text = HEAD + "gone = Sphere('gone')\nworkspace.current().delete(gone._bpy_object.node)\n" + BODY + END
    load("from morse.builder import workspace\n" + text)


# -- the physics of objects from model files, as scripts set it ------------------------------------

SCENE = """
from morse.builder import *
shelf = PassiveObject({file!r})
shelf.translate(3, 0, 2)
shelf.static()
crate = PassiveObject({file!r})
crate.translate(0, 0, 2)
crate.set_mass(7)
crate.set_friction(0.3)
crate.set_damping(0.0, 0.0)
env = Environment('empty', fastmode=True)
"""


def test_a_script_sets_the_physics_of_an_object(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / "box.glb")))
    with morse.load(tmp_path / "scene.py") as sim:
        shelf, crate = (sim.world.game_object(name) for name in ("shelf", "crate"))
        assert crate.mass == pytest.approx(7.0)
        sim.step(30)
        assert shelf.world_pose()[0][2] == 2.0
        # 0.5 s of free fall without damping
        assert crate.world_pose()[0][2] == pytest.approx(2.0 - 0.5 * 9.81 * 0.25, abs=0.03)
        sim.step(60)
        assert crate.world_pose()[0][2] == pytest.approx(0.2, abs=0.01)


def test_shares_are_from_0_to_1(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    script = f"from morse.builder import *\nPassiveObject({str(tmp_path / 'box.glb')!r}).set_restitution(2)\n"
    (tmp_path / "scene.py").write_text(script + "Environment('empty')\n")
    with pytest.raises(Exception, match=r"set_restitution\(restitution\) takes a number from 0 to 1, got 2"):
        morse.load(tmp_path / "scene.py")


def test_properties_without_effect_are_refused(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    script = f"from morse.builder import *\nPassiveObject({str(tmp_path / 'box.glb')!r}).properties(mass=7)\n"
    (tmp_path / "scene.py").write_text(script + "Environment('empty')\n")
    with pytest.raises(Exception, match=r"properties\(mass=...\) has no effect.*use set_mass\(\)"):
        morse.load(tmp_path / "scene.py")
