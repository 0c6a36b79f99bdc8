"""One scene, saved by five versions of Blender: the result must be the scene of `make_scene.py`."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from morse.mathutils import Vector
from morse.plugins.blend import read_blend
from morse.scene import Bounds, Library, Node, NodeKind, PhysicsType

pytestmark = pytest.mark.long

CUBE = {(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)}


@pytest.fixture
def library(scene_path: Path) -> Library:
    return read_blend(scene_path)


@pytest.fixture
def nodes(library: Library) -> dict[str, Node]:
    return {node.name: node for node in library.nodes()}


def area_vectors(node: Node) -> np.ndarray:
    """(T, 3) normals of the triangles, with the lengths of their areas."""
    assert node.mesh is not None
    a, b, c = (node.mesh.vertices[node.mesh.triangles[:, i]].astype(float) for i in range(3))
    return np.cross(b - a, c - a) / 2


def test_nothing_is_lost(library: Library, nodes: dict[str, Node]) -> None:
    assert library.warnings == []
    assert len(nodes) == 41
    assert all(node.source_name for node in nodes.values())


def test_every_object_is_where_blender_has_it(library: Library, nodes: dict[str, Node]) -> None:
    originals = [node for node in nodes.values() if node.name == node.source_name]
    assert len(originals) == 37
    for node in originals:
        world = [value for row in node.world_matrix() for value in row]
        assert world == pytest.approx(node.properties["world"], abs=2e-5), node.name


def test_euler_angles_stay_as_they_were_typed(nodes: dict[str, Node]) -> None:
    assert nodes["plain"].rotation_euler == pytest.approx([7.0, -0.7, 1.9])


def test_a_concave_polygon_is_covered_once(nodes: dict[str, Node]) -> None:
    areas = area_vectors(nodes["ell"])
    assert len(areas) == 4
    assert (areas[:, 2] > 0).all()
    assert areas.sum(axis=0) == pytest.approx([0, 0, 3])


def test_faces_look_outward(nodes: dict[str, Node]) -> None:
    mesh = nodes["cube"].mesh
    assert {tuple(vertex) for vertex in mesh.vertices.tolist()} == CUBE
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", centres, area_vectors(nodes["cube"])) > 0).all()
    assert mesh.normals is None


def test_each_polygon_has_its_material(nodes: dict[str, Node]) -> None:
    mesh = nodes["cube"].mesh
    red, wood = mesh.materials
    assert red.color == pytest.approx((0.5, 0.25, 0.125, 0.5))
    assert (red.roughness, red.metallic, red.image) == (0.25, 0.75, None)
    # the last face of the cube faces up
    upward = area_vectors(nodes["cube"])[:, 2] > 0.1
    assert (mesh.material_index == upward).all()
    assert wood.color == (1, 1, 1, 1)
    assert wood.image.mime == "image/png"
    assert wood.image.data.startswith(b"\x89PNG")


def test_an_object_can_have_a_material_of_its_own(nodes: dict[str, Node]) -> None:
    painted = nodes["painted"]
    assert painted.mesh is nodes["cube"].mesh
    assert painted.materials[0].color == pytest.approx((0, 1, 0, 1))
    assert painted.materials[1] is painted.mesh.materials[1]
    assert nodes["cube"].materials == []


def test_emission_and_culling(nodes: dict[str, Node]) -> None:
    (glow,) = nodes["can"].mesh.materials
    assert glow.emission == pytest.approx((1.0, 0.5, 2.0))
    assert not glow.double_sided
    assert nodes["cube"].mesh.materials[0].double_sided


def test_the_uv_layer_for_rendering_is_taken(nodes: dict[str, Node]) -> None:
    uvs = nodes["cube"].mesh.uvs
    assert uvs.shape == (12, 3, 2)
    assert {tuple(uv) for uv in uvs.reshape(-1, 2).tolist()} == {(0, 0), (2, 0), (2, 2), (0, 2)}


def test_sharp_edges_part_the_normals(nodes: dict[str, Node]) -> None:
    mesh = nodes["can"].mesh
    wall = np.abs(area_vectors(nodes["can"])[:, 2]) < 1e-6
    corners = mesh.vertices[mesh.triangles]
    outward = corners[wall] * [1, 1, 0]
    assert mesh.normals[wall] == pytest.approx(outward, abs=1e-6)
    assert np.abs(mesh.normals[~wall]) == pytest.approx(np.broadcast_to([0.0, 0, 1], (np.sum(~wall), 3, 3)), abs=1e-6)


def test_custom_properties(nodes: dict[str, Node]) -> None:
    properties = dict(nodes["tagged"].properties)
    del properties["world"]
    assert properties == {
        "flag": True,
        "count": -7,
        "share": 0.1,
        "label": "grün",
        "numbers": [1, 2, 3],
        "reals": [0.5, 1.5],
        "group": {"inner": {"name": "deep"}, "value": 2},
    }


def test_custom_properties_decide_the_physics(nodes: dict[str, Node]) -> None:
    body = nodes["tagged"].body
    assert (body.type, body.bounds, body.mass, body.ghost) == (PhysicsType.DYNAMIC, Bounds.CAPSULE, 2.5, True)


@pytest.mark.parametrize(
    ("name", "kind", "bounds", "compound"),
    [
        ("rb_active", PhysicsType.RIGID_BODY, Bounds.BOX, False),
        ("rb_passive", PhysicsType.STATIC, Bounds.TRIANGLE_MESH, False),
        ("rb_kinematic", PhysicsType.STATIC, Bounds.CAPSULE, False),
        ("rb_disabled", PhysicsType.STATIC, Bounds.CONVEX_HULL, False),
        ("rb_compound", PhysicsType.RIGID_BODY, None, True),
    ],
)
def test_rigid_bodies(
    nodes: dict[str, Node], name: str, kind: PhysicsType, bounds: Bounds | None, compound: bool
) -> None:
    body = nodes[name].body
    assert (body.type, body.bounds, body.compound) == (kind, bounds, compound)
    assert (body.mass, body.friction, body.restitution) == (3.5, 0.25, 0.75)
    assert (body.linear_damping, body.angular_damping) == (0.5, 0.125)


def test_objects_without_settings_are_left_open(nodes: dict[str, Node]) -> None:
    assert nodes["cube"].body.type is PhysicsType.AUTO
    assert nodes["base"].body.type is PhysicsType.AUTO


@pytest.mark.parametrize(("name", "energy"), [("point", 1.0), ("sun", 1.0), ("spot", 2.0), ("area", 1.0)])
def test_lights(nodes: dict[str, Node], name: str, energy: float) -> None:
    light = nodes[name].light
    assert nodes[name].kind is NodeKind.LIGHT
    assert light.type == name.upper()
    assert light.energy == pytest.approx(energy)
    assert light.color == (1.0, 0.5, 0.25)
    assert light.casts_shadow == (name != "point")
    if name == "spot":
        assert light.spot_size == pytest.approx(pi / 3)


def test_cameras(nodes: dict[str, Node]) -> None:
    camera = nodes["camera"].camera
    assert camera.focal_length == pytest.approx(50 * 32 / 36)
    assert (camera.clip_start, camera.clip_end) == (0.25, 500)


def test_collections(library: Library) -> None:
    assert library.collections["outer"] == ["base", "arm"]
    assert library.collections["inner"] == ["arm"]
    assert library.collections["template"] == ["post", "sign"]


def test_instances_are_copies_where_they_are_seen(library: Library, nodes: dict[str, Node]) -> None:
    assert library.outside_scene == {"post", "sign"}
    for name, x in (("left", -3), ("right", 3)):
        (post,) = nodes[name].children
        (sign,) = post.children
        assert (post.source_name, sign.source_name) == ("post", "sign")
        assert post.world_matrix().translation == pytest.approx((x, 0, 0), abs=1e-6)
        assert sign.world_matrix().translation == pytest.approx((x, 0, 2), abs=1e-6)
        assert post.world_matrix() * Vector((1, 0, 0)) == pytest.approx((x, 1, 0), abs=1e-6)
        assert post.mesh is nodes["post"].mesh


def test_hidden_objects_are_read_too(nodes: dict[str, Node]) -> None:
    assert not nodes["unseen"].visible
    assert nodes["excluded"].visible
    assert nodes["excluded"].mesh is nodes["cube"].mesh


def test_the_world(library: Library) -> None:
    assert library.world["gravity"] == pytest.approx(1.62)
    assert library.world["horizon_color"] == pytest.approx((0.125, 0.25, 0.375))
