"""The model files have the names, positions, sizes, masses and properties that scripts for MORSE rely on."""

import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import zstandard

import morse
from morse.mathutils import Euler
from morse.plugins.blend import read_blend
from morse.scene import Library, Node

DATA = Path(morse.__file__).parent / "data"
#: bounding boxes are those of 1.4 to a centimetre; the recorded positions have three digits
SIZE, PLACE, ANGLE = 0.011, 0.006, 0.006
#: names of shapes that are only used by the physics
COLLIDER = re.compile(r"_bb|^BB_|_bou|_collision$", re.IGNORECASE)


@dataclass(frozen=True)
class Fact:
    file: str
    object: str
    parent: str
    type: str
    xyz: str
    rpy: str
    size: str
    centre: str
    physics: str
    bounds: str
    mass: str
    props: str

    def numbers(self, name: str) -> np.ndarray:
        return np.array([float(word) for word in getattr(self, name).split()])


def _facts() -> list[Fact]:
    lines = (Path(__file__).parent / "asset_facts.tsv").read_text().splitlines()
    return [Fact(*line.split("\t")) for line in lines if not line.startswith(("#", "file\t"))]


FACTS = _facts()
FILES = sorted(path.relative_to(DATA).with_suffix("").as_posix() for path in DATA.rglob("*.blend"))


@cache
def library(name: str) -> Library:
    return read_blend(DATA / f"{name}.blend")


@cache
def nodes(name: str) -> dict[str, Node]:
    return {node.name: node for node in library(name).nodes()}


def position(node: Node) -> np.ndarray:
    world = node.world_matrix()
    return np.array([world[row][3] for row in range(3)])


def box(node: Node) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner in the node's own frame, including its scale."""
    assert node.mesh is not None
    points = node.mesh.vertices * np.array(node.scale)
    return points.min(axis=0), points.max(axis=0)


def world_points(node: Node) -> np.ndarray:
    assert node.mesh is not None
    world = np.array([list(row) for row in node.world_matrix()])
    return node.mesh.vertices @ world[:3, :3].T + world[:3, 3]


@pytest.mark.parametrize("name", sorted({fact.file for fact in FACTS}))
def test_objects_are_where_and_what_scripts_expect(name: str) -> None:
    wrong = []
    for fact in FACTS:
        if fact.file == name:
            try:
                _is_where_and_what_scripts_expect(fact)
            except (AssertionError, KeyError) as error:
                wrong.append(f"{fact.object}: {error!r}")
    assert wrong == []


def _is_where_and_what_scripts_expect(fact: Fact) -> None:
    node = nodes(fact.file)[fact.object]
    assert (node.parent.name if node.parent else "") == fact.parent
    assert node.kind.value == fact.type
    np.testing.assert_allclose(position(node), fact.numbers("xyz"), atol=PLACE)
    turned = np.array([list(row) for row in node.world_matrix()])[:3, :3]
    np.testing.assert_allclose(
        turned, np.array([list(r) for r in Euler(fact.numbers("rpy").tolist()).to_matrix()]), atol=ANGLE
    )
    if fact.size:
        low, high = box(node)
        np.testing.assert_allclose(high - low, fact.numbers("size"), atol=SIZE)
        np.testing.assert_allclose((high + low) / 2, fact.numbers("centre"), atol=SIZE)
    assert node.body.type.value == fact.physics
    if fact.bounds:
        assert node.body.bounds is not None
        assert node.body.bounds.value == fact.bounds
    if fact.mass:
        assert node.body.mass == pytest.approx(float(fact.mass))
    for key, value in json.loads(fact.props or "{}").items():
        assert node.properties[key] == value, key


@pytest.mark.parametrize("name", FILES)
def test_file_is_complete_and_says_nothing_of_its_maker(name: str) -> None:
    path = DATA / f"{name}.blend"
    with path.open("rb") as file:
        content = zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True).read()
    assert content.startswith(b"BLENDER-v304"), "files of 3.4 open in every later Blender"
    for trace in (b"/home/", b"/root\0", b"/work/", b"/tmp/", b"/usr/", b"C:\\"):
        assert trace not in content
    found = library(name)
    assert not found.warnings
    for node in found.nodes():
        if node.mesh is None:
            continue
        assert len(node.mesh.triangles) < 30_000
        assert np.isfinite(node.mesh.vertices).all()
        for material in node.materials or node.mesh.materials:
            if node.visible:
                assert material is not None, f"{node.name} has no material"
        corners = node.mesh.vertices[node.mesh.triangles]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        assert np.count_nonzero(areas < 1e-12) <= 0.02 * len(areas), f"{node.name} has triangles without area"


@pytest.mark.parametrize("name", FILES)
def test_hidden_shapes_are_only_those_for_collisions(name: str) -> None:
    hidden = [node for node in nodes(name).values() if not node.visible]
    for node in hidden:
        assert COLLIDER.search(node.name), node.name
        assert node.body.collides
    for node in nodes(name).values():
        if node.mesh is not None and COLLIDER.search(node.name):
            assert not node.visible, f"{node.name} would be seen"


def test_crates_come_as_collections() -> None:
    collections = library("props/crates").collections
    assert set(collections["small_crate"]) == {"small_crate", "small_crate_bb", "small_crate_mesh"}
    assert {f"large_crate_bb_0{number}" for number in range(1, 6)} < set(collections["large_crate"])
    assert {f"transport_box_bb_0{number}" for number in range(1, 5)} < set(collections["transport_box"])
    for name in ("small_crate", "large_crate", "transport_box"):
        assert nodes("props/crates")[name].body.compound


def pieces(node: Node) -> list[np.ndarray]:
    """Indices of the triangles of each connected piece."""
    assert node.mesh is not None
    _, ids = np.unique(np.round(node.mesh.vertices, 5), axis=0, return_inverse=True)
    ids = ids.reshape(-1)
    triangles = node.mesh.triangles  # connected by vertices, not by positions: boards that touch stay separate
    label = np.arange(len(node.mesh.vertices))
    while True:
        lowest = label[triangles].min(axis=1)
        new = label.copy()
        np.minimum.at(new, triangles.ravel(), np.repeat(lowest, 3))
        if (new == label).all():
            break
        label = new
    owner = label[triangles[:, 0]]
    return [np.flatnonzero(owner == value) for value in np.unique(owner)]


def test_small_crate_can_be_made_into_a_robot_by_hand() -> None:
    """The tutorial removes the diagonal boards, loose pieces of the mesh, and extrudes the top of the box inside."""
    node = nodes("props/crates")["small_crate_mesh"]
    assert node.mesh is not None
    points = world_points(node)
    diagonal, core = 0, []
    for triangles in pieces(node):
        corners = points[np.unique(node.mesh.triangles[triangles])]
        extent = np.ptp(corners, axis=0)
        if np.count_nonzero(extent > 0.6) == 2:
            # a board along an edge fills its bounding box, a diagonal board does not fill two corners
            low, high = corners.min(axis=0), corners.max(axis=0)
            flat = int(np.argmin(extent))
            across = [axis for axis in range(3) if axis != flat]
            nearest = [
                np.min(np.linalg.norm(corners[:, across] - np.array([u, v]), axis=1))
                for u in (low[across[0]], high[across[0]])
                for v in (low[across[1]], high[across[1]])
            ]
            diagonal += max(nearest) > 0.2
        if (extent > 0.85).all():
            core.append((corners, triangles))
    assert diagonal == 6
    assert len(core) == 1
    corners, triangles = core[0]
    assert len(corners) == 8
    assert len(triangles) == 12


def test_atrv_is_carried_with_its_origin_a_tenth_above_the_ground() -> None:
    parts = nodes("robots/atrv")
    colliding = [node for node in parts.values() if node.mesh is not None and node.body.collides]
    lowest = min(world_points(node)[:, 2].min() for node in colliding)
    assert lowest == pytest.approx(0.0, abs=1e-6)
    assert position(parts["ATRV"])[2] == pytest.approx(0.1, abs=1e-6)
    assert parts["ATRV"].body.compound


@pytest.mark.parametrize("name", ["robots/morsy", "templates/robot"])
def test_mascot_looks_along_x(name: str) -> None:
    mesh = nodes(name)["morsy_mesh"]
    assert mesh.mesh is not None
    slots = [material.name if material else "" for material in mesh.mesh.materials]
    assert slots[0] == "Body", "the first slot is the colour of the body"
    eyes = mesh.mesh.triangles[mesh.mesh.material_index == slots.index("Eye")]
    points = world_points(mesh)[np.unique(eyes)]
    assert points[:, 0].min() > 0.25
    assert points[:, 2].min() > 1.1
    assert abs(points[:, 1].mean()) < 0.01


def test_template_robot_has_the_body_of_the_tutorial() -> None:
    parts = nodes("templates/robot")
    assert list(parts) == ["morsy", "morsy_bb", "morsy_mesh"]
    body = parts["morsy"].body
    assert (body.type.value, body.compound, body.mass) == ("RIGID_BODY", True, 15.0)
    assert (body.linear_damping, body.angular_damping) == pytest.approx((0.2, 0.4))
    low, high = box(parts["morsy_bb"])
    np.testing.assert_allclose((high - low) / 2, [0.409, 0.591, 0.787], atol=1e-3)
    assert position(parts["morsy_bb"])[2] == pytest.approx(0.826)


def test_stored_dampings() -> None:
    for name, root, linear, angular in (("robots/morsy", "morsy", 0.49, 0.66), ("robots/atrv", "ATRV", 0.025, 0.18)):
        body = nodes(name)[root].body
        assert (body.linear_damping, body.angular_damping) == pytest.approx((linear, angular))


def test_pioneer_carries_the_settings_of_its_wheels() -> None:
    properties = nodes("robots/pioneer3dx")["Pioneer"].properties
    assert properties["FixTurningSpeed"] == pytest.approx(0.52)
    assert properties["Influence"] == pytest.approx(0.1)
    assert properties["Friction"] == pytest.approx(0.8)


def test_worlds_have_a_sky_and_a_sun() -> None:
    for name in (name for name in FILES if name.startswith("environments/")):
        assert "horizon_color" in library(name).world, name
        assert any(node.light is not None for node in library(name).nodes()), name
