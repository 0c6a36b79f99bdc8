"""Meshes and scenes in the format for pages."""

import json
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from view_pages import Client, fetch
from view_worlds import box, chequers, mesh_node, playground

from morse.rendering.distortion import lens_of
from morse.rendering.lens import Lens
from morse.scene import Material, Mesh, Node, Scene
from morse.scene.frames import rigid_frame
from morse.viewer.describe import describe, rigid_frames
from morse.viewer.feeds.sensors import SIDE, ViewFrustums, rim
from morse.viewer.hub import Wishes
from morse.viewer.site import AssetStore, PackedMesh, pack_mesh
from morse.viewer.snapshot import MovingNode
from tests.kit.effort import examples


def unpack(packed: PackedMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray]:
    v = packed.vertices
    floats = np.frombuffer(packed.data, "<f4", count=v * (8 if packed.textured else 6))
    indices = np.frombuffer(packed.data, "<u4", offset=floats.nbytes)
    assert len(indices) == packed.indices
    uvs = floats[v * 6 :].reshape(v, 2) if packed.textured else None
    return floats[: v * 3].reshape(v, 3), floats[v * 3 : v * 6].reshape(v, 3), uvs, indices


def test_a_flat_cube_has_24_vertices_and_outward_normals() -> None:
    positions, normals, _, indices = unpack(pack_mesh(box("cube")))
    assert len(positions) == 24  # four at each of six sides: normals differ at the edges
    assert len(indices) == 36
    corners = positions[indices].reshape(-1, 3, 3)
    outward = corners.mean(axis=1)
    turning = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", turning, outward) > 0).all()  # counter-clockwise from outside
    assert (np.einsum("ij,ij->i", normals[indices[::3]], outward) > 0.49).all()
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_smooth_corners_are_joined() -> None:
    cube = box("cube")
    normals = cube.vertices[cube.triangles] / math.sqrt(0.75)
    positions, _, _, _ = unpack(pack_mesh(Mesh("c", cube.vertices, cube.triangles, cube.material_index, None, normals)))
    assert len(positions) == 8


def test_triangles_are_grouped_by_material() -> None:
    packed = pack_mesh(box("cube", Material("a"), Material("b"), Material("c")))
    assert packed.groups == ((0, 12, 0), (12, 12, 1), (24, 12, 2))


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(1, 40), st.integers(0, 3), st.booleans(), st.randoms(use_true_random=False))
def test_packing_keeps_every_corner(count, materials, textured, random) -> None:
    rng = np.random.default_rng(random.randrange(2**32))
    vertices = rng.integers(-2, 3, (9, 3)).astype(np.float32)
    triangles = rng.integers(0, 9, (count, 3)).astype(np.int32)
    slots = rng.integers(0, materials + 1, count).astype(np.int32)
    uvs = rng.integers(0, 2, (count, 3, 2)).astype(np.float32) if textured else None
    packed = pack_mesh(Mesh("m", vertices, triangles, slots, uvs))
    positions, _, packed_uvs, indices = unpack(packed)
    for start, length, slot in packed.groups:
        chosen = slots == slot
        part = indices[start : start + length]
        assert np.array_equal(positions[part].reshape(-1, 3, 3), vertices[triangles[chosen]])
        if uvs is not None:
            assert packed_uvs is not None
            assert np.array_equal(packed_uvs[part].reshape(-1, 3, 2), uvs[chosen])
    assert sum(length for _, length, _ in packed.groups) == 3 * count


def test_degenerate_meshes_are_packed() -> None:
    empty = Mesh("e", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32), np.zeros(0, np.int32))
    assert pack_mesh(empty).groups == ()
    point = Mesh("p", np.full((1, 3), np.nan, np.float32), np.zeros((1, 3), np.int32), np.zeros(1, np.int32))
    assert np.isfinite(unpack(pack_mesh(point))[0]).all()


def test_poses_are_rigid_and_scale_goes_to_the_mesh() -> None:
    parent = Node("parent", location=[1, 0, 0], rotation_euler=[0, 0, math.pi / 2], scale=[2, 2, 2])
    child = mesh_node("child", box("c"), (1.0, 0.0, 0.0), scale=[1, 3, 1])
    parent.attach(child)
    scene = Scene("s", roots=[parent])
    described = describe(scene, [MovingNode(child, "parent")], 1, AssetStore())
    node = described.nodes[1]
    assert node.parent == 0
    assert node.position == pytest.approx((2.0, 0.0, 0.0))  # metres along the parent's axes
    assert node.quaternion == pytest.approx((1, 0, 0, 0))
    assert node.stretch == pytest.approx((2, 0, 0, 0, 6, 0, 0, 0, 2))
    assert described.moving == [1]
    assert node.frame == "parent"


def test_hidden_nodes_and_materials() -> None:
    a, b = Material("a", (1, 0, 0, 1)), Material("b", (0, 1, 0, 1))
    mesh = box("m", a, a)
    scene = Scene("s", roots=[
        mesh_node("plain", mesh), mesh_node("own", mesh, materials=[None, b]), mesh_node("bare", box("bare")),
        mesh_node("off", mesh, properties={"visible": 0}), mesh_node("out", mesh, visible=False),
        mesh_node("on", mesh, properties={"visible": 1}),
    ])  # fmt: skip
    described = describe(scene, [], 1, AssetStore())
    names = {node.name: [described.materials[i].name for i in node.materials] for node in described.nodes}
    assert names["plain"] == ["a", "a"]
    assert names["own"] == ["a", "b"]
    assert names["bare"] == [""]
    assert {node.name for node in described.nodes if not node.visible} == {"off", "out"}


def test_equal_meshes_are_sent_once_and_a_changed_scene_sends_only_what_is_new() -> None:
    asset_store = AssetStore()
    scene = Scene("s", roots=[mesh_node("a", box("a")), mesh_node("b", box("b")), mesh_node("c", box("c", size=2.0))])
    described = describe(scene, [], 1, asset_store)
    assert [node.mesh for node in described.nodes] == [0, 0, 1]
    assert len(asset_store.take_new()) == 1
    scene.roots.append(mesh_node("d", box("d", size=3.0)))
    described = describe(scene, [], 2, asset_store)
    (data,) = (data for _, data in asset_store.take_new().values())
    assert len(data) == 24 * 24 + 36 * 4
    assert [node.mesh for node in described.nodes] == [0, 0, 1, 2]
    assert asset_store.take_new() == {}


def test_world_geometry_and_pictures_are_fetched_over_http(served) -> None:
    server, url = served
    scene, moving = playground()
    server.set_scene(scene, moving)
    with Client(url) as page:
        world = page.expect("world")
    status, headers, body = fetch(url[:-1] + world["url"], {"Accept-Encoding": "identity"})
    assert status == 200
    assert headers["Content-Type"] == "application/json"
    described = json.loads(body)
    mesh = described["meshes"][0]
    status, headers, geometry = fetch(url[:-1] + mesh["url"])
    assert status == 200
    assert "immutable" in headers["Cache-Control"]
    assert len(geometry) >= mesh["offset"] + mesh["vertices"] * 32 + mesh["indices"] * 4
    assert fetch(url[:-1] + mesh["url"], {"If-None-Match": headers["ETag"]})[0] == 304
    picture = next(m["image"] for m in described["materials"] if m["image"])
    status, headers, data = fetch(url[:-1] + picture)
    assert headers["Content-Type"] == "image/png"
    assert data == chequers((176, 124, 74), (150, 100, 56)).data


@pytest.mark.parametrize(
    "path", ["/../server.py", "/%2e%2e/server.py", "/assets/../../server.py", "/nothing", "/files/0"]
)
def test_nothing_else_is_fetched(served, path) -> None:
    _, url = served
    assert fetch(url[:-1] + path)[0] == 404


numbers = st.floats(-3.0, 3.0).map(lambda x: round(x, 3))
vectors = st.lists(numbers, min_size=3, max_size=3)


@settings(max_examples=examples(60), deadline=None)
@given(st.lists(st.tuples(vectors, vectors, vectors, st.integers(-1, 7), st.booleans()), min_size=1, max_size=8))
def test_frames_of_many_nodes_are_those_of_each(parts) -> None:
    nodes: list[Node] = []
    for i, (location, rotation, scale, parent, keep) in enumerate(parts):
        node = Node(f"n{i}", location=location, rotation_euler=rotation, scale=scale)
        determinant = math.prod(scale)
        if 0 <= parent < i and (not keep or (abs(determinant) > 0.1 and abs(math.prod(nodes[parent].scale)) > 0.1)):
            invertible = all(abs(math.prod(a.scale)) > 0.1 for a in (nodes[parent], *nodes[parent].ancestors()))
            nodes[parent].attach(node, keep_world_pose=keep and invertible)
        nodes.append(node)
    ordered = [node for root in nodes if root.parent is None for node in root.walk()]
    frames = rigid_frames(ordered)
    for i, node in enumerate(ordered):
        one = rigid_frame(node)
        assert frames.stretches[i] == pytest.approx(np.array([list(row) for row in one.stretch]), abs=1e-6)
        rotation, position = np.array([list(row) for row in one.rotation]), np.array(list(one.position))
        if node.parent is not None:
            above = rigid_frame(node.parent)
            back = np.array([list(row) for row in above.rotation]).T
            rotation, position = back @ rotation, back @ (position - np.array(list(above.position)))
        assert frames.positions[i] == pytest.approx(position, abs=1e-6)
        w, x, y, z = frames.quaternions[i]
        turned = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        assert np.array(turned) == pytest.approx(rotation, abs=1e-6)


# -- the fields of view of cameras, as pages are told ----------------------------------------------


def test_the_corners_of_a_pinhole_picture() -> None:
    lens = Lens.of_angle(64, 48, math.radians(90.0))
    corners = rim(lens)[::SIDE]
    # 45 degrees to the sides, and 48/64 of it up and down; clockwise from the upper left
    wanted = np.array([[-1, -0.75, 1], [1, -0.75, 1], [1, 0.75, 1], [-1, 0.75, 1]])
    np.testing.assert_allclose(corners / corners[:, 2:], wanted, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rim(lens), axis=1), 1.0)


def test_a_fisheye_lens_looks_to_the_sides_as_far_as_it_sees() -> None:
    lens = lens_of(65, 65, 25.0, 180.0, 0.1, 100.0, "equidistant", "")
    directions = rim(lens)
    middle_of_right = directions[SIDE + SIDE // 2]
    assert math.degrees(math.acos(middle_of_right[2])) == pytest.approx(90.0, abs=2.0)
    assert middle_of_right[0] > 0.99


def test_a_lens_that_shows_nothing_in_its_corners_is_followed_inward() -> None:
    lens = lens_of(65, 65, 25.0, 340.0, 0.1, 100.0, "equidistant", "")
    directions = rim(lens)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, atol=1e-6)
    # the corner is beyond half a turn: what is next to it looks almost straight back
    assert directions[0][2] < -0.9


def test_a_field_of_view_is_sent_once_for_each_lens() -> None:
    camera = SimpleNamespace(lens=Lens.of_angle(64, 48, 1.0, 0.1, 5.0))
    sent: list[Any] = []
    server = SimpleNamespace(wishes=Wishes(overlays=frozenset({"eye", "laser", "nobody"})), send=sent.append)
    context = SimpleNamespace(components={"eye": camera, "laser": SimpleNamespace()})
    feed = ViewFrustums(context, server)  # type: ignore[arg-type]
    feed.update()
    feed.update()
    assert [(one.component, one.near, one.far, len(one.rim)) for one in sent] == [("eye", 0.1, 5.0, 4 * SIDE)]
    camera.lens = Lens.of_angle(64, 48, 2.0)
    feed.update()
    assert len(sent) == 2
