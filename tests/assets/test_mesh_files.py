"""glTF, OBJ, STL and PLY files as models: shapes, axes, materials, and damaged or malicious files."""

import contextlib
import io
import json
import math
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

import morse
from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.pictures import HEADER_SIZE, TargaError, is_targa, png_of
from morse.builder import Environment, FakeRobot, PassiveObject
from tests.kit.effort import examples

CHEQUERED = {(255, 0, 255), (255, 255, 255)}
FORMATS = ("glb", "obj", "stl", "ply")


def saved(path: Path, *parts: tuple[str, Any, tuple[float, float, float]]) -> Path:
    scene = trimesh.Scene()
    for name, mesh, at in parts:
        scene.add_geometry(mesh, node_name=name, transform=trimesh.transformations.translation_matrix(at))
    path.write_bytes(trimesh.exchange.gltf.export_glb(scene))
    return path


def brick(path: Path) -> Path:
    """0.4 m long, 0.2 m wide, 0.6 m high."""
    trimesh.creation.box((0.4, 0.2, 0.6)).export(path)
    return path


def extent(path: Path) -> np.ndarray:
    corners = []
    for node in load(path).nodes():
        if node.mesh is not None:
            matrix = np.array([list(row) for row in node.world_matrix()])
            corners.append(node.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3])
    return np.ptp(np.concatenate(corners), axis=0)


@pytest.mark.parametrize("suffix", FORMATS)
def test_sizes_are_those_of_the_file(tmp_path: Path, suffix: str) -> None:
    # the axes X, Y, Z of glTF are left, up and ahead
    wanted = [0.6, 0.4, 0.2] if suffix == "glb" else [0.4, 0.2, 0.6]
    assert extent(brick(tmp_path / f"brick.{suffix}")) == pytest.approx(wanted, abs=1e-6)


def test_the_front_of_gltf_is_x_and_its_top_is_z(tmp_path: Path) -> None:
    dot = trimesh.creation.box((0.1, 0.1, 0.1))
    path = saved(tmp_path / "axes.glb", ("left", dot, (1, 0, 0)), ("up", dot, (0, 1, 0)), ("ahead", dot, (0, 0, 1)))
    at = {node.name: list(node.world_matrix().translation) for node in load(path).nodes()}
    assert at["ahead"] == pytest.approx([1, 0, 0])
    assert at["left"] == pytest.approx([0, 1, 0])
    assert at["up"] == pytest.approx([0, 0, 1])


def test_names_and_parents_are_kept(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), node_name="body")
    eye = trimesh.transformations.translation_matrix([0.0, 0.5, 0.25])
    scene.add_geometry(trimesh.creation.icosphere(), node_name="eye", parent_node_name="body", transform=eye)
    path = tmp_path / "head.glb"
    path.write_bytes(trimesh.exchange.gltf.export_glb(scene))
    (root,) = load(path).roots
    assert root.name == "body"
    (child,) = root.children
    assert child.name == "eye"
    assert list(child.world_matrix().translation) == pytest.approx([0.25, 0.0, 0.5])


def test_colours_and_pictures(tmp_path: Path) -> None:
    picture = Image.new("RGB", (4, 4), (255, 0, 0))
    look = trimesh.visual.material.PBRMaterial(
        baseColorFactor=[0.5, 0.25, 1.0, 1.0], metallicFactor=0.3, roughnessFactor=0.7, baseColorTexture=picture
    )
    mesh = trimesh.creation.box((1, 1, 1))
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)), material=look)
    (root,) = load(saved(tmp_path / "painted.glb", ("painted", mesh, (0, 0, 0)))).roots
    (material,) = root.materials
    assert material.color == pytest.approx((0.5, 0.25, 1.0, 1.0), abs=0.01)
    assert (material.metallic, material.roughness) == pytest.approx((0.3, 0.7))
    assert material.image.mime == "image/png"
    assert root.mesh.uvs.shape == (12, 3, 2)


def test_a_sphere_is_smooth_and_a_box_is_not(tmp_path: Path) -> None:
    trimesh.creation.icosphere(subdivisions=3).export(tmp_path / "ball.stl")
    (ball,) = load(tmp_path / "ball.stl").roots
    outward = ball.mesh.vertices[ball.mesh.triangles]
    assert np.einsum("tcx,tcx->tc", ball.mesh.normals, outward).min() > 0.999
    (box,) = load(brick(tmp_path / "brick.stl")).roots
    assert set(np.abs(box.mesh.normals).max(axis=2).ravel().round(6)) == {1.0}


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_thing_falls_and_rests_on_its_lower_side(tmp_path: Path, suffix: str) -> None:
    path = brick(tmp_path / f"brick.{suffix}")

    def scene() -> None:
        FakeRobot("robot")
        thing = PassiveObject(str(path))
        thing.name = "thing"
        thing.translate(2.0, 0.0, 1.0)
        Environment("empty", fastmode=True)

    with morse.load(scene) as simulation:
        simulation.step(180)
        body = next(body for body in simulation.world.objects() if body.name == "thing")
        # glTF is converted to Z up: 0.2 m along its Z axis is the length, 0.2 m along Y the height
        assert body.worldPosition.z == pytest.approx(0.1 if suffix == "glb" else 0.3, abs=0.01)
        assert body.worldPosition.x == pytest.approx(2.0, abs=0.01)


# -- untrusted files ---------------------------------------------------------------------------------------


def _colours(data: bytes) -> set[Any]:
    return {colour for _, colour in Image.open(io.BytesIO(data)).getcolors()}


def test_pictures_elsewhere_are_not_read(tmp_path: Path) -> None:
    secret = tmp_path / "secret.png"
    Image.new("RGB", (2, 2), (1, 2, 3)).save(secret)
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / "m.mtl").write_text(f"newmtl a\nKd 1 1 1\nmap_Kd ../secret.png\nnewmtl b\nmap_Kd {secret}\n")
    (folder / "m.obj").write_text(
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
    )
    library = load(folder / "m.obj")
    assert all(_colours(image.data) == CHEQUERED for image in library.images.values())
    assert any("secret.png" in warning for warning in library.warnings)


@pytest.mark.parametrize("size", [(30_000, 30_000), (9_000, 9_000), (2**31 - 1, 2**31 - 1), None])
def test_pictures_that_cannot_be_used_are_named_before_they_are_decoded(
    tmp_path: Path, size: tuple[int, int] | None
) -> None:
    """A header announces many pixels; and a text with the name of a picture."""
    header = b"" if size is None else struct.pack(">4sIIBBBBB", b"IHDR", *size, 8, 2, 0, 0, 0)
    checked = struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))
    (tmp_path / "p.png").write_bytes(b"no picture" if size is None else b"\x89PNG\r\n\x1a\n" + checked)
    (tmp_path / "m.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd p.png\n")
    (tmp_path / "m.obj").write_text(
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
    )
    library = load(tmp_path / "m.obj")
    assert [_colours(image.data) for image in library.images.values()] == [CHEQUERED]
    (warning,) = library.warnings
    assert warning.startswith("the picture 'p.png' is replaced by a chequered pattern: ")


@pytest.mark.parametrize("name", ["missing.png", "half.jpg"])
def test_a_chequered_pattern_replaces_a_picture(tmp_path: Path, name: str) -> None:
    if name == "half.jpg":
        whole = io.BytesIO()
        Image.effect_noise((64, 64), 50).save(whole, "JPEG")
        (tmp_path / name).write_bytes(whole.getvalue()[: len(whole.getvalue()) // 2])
    (tmp_path / "m.mtl").write_text(f"newmtl a\nmap_Kd {name}\n")
    (tmp_path / "m.obj").write_text(
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
    )
    library = load(tmp_path / "m.obj")
    (material,) = library.roots[0].materials
    assert _colours(material.image.data) == CHEQUERED
    assert ["replaced by a chequered pattern" in warning for warning in library.warnings] == [True]


def test_a_gltf_reads_nothing_outside_its_folder(tmp_path: Path) -> None:
    (tmp_path / "outside.bin").write_bytes(np.zeros(9, "<f4").tobytes())
    folder = tmp_path / "model"
    folder.mkdir()
    content = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": "../outside.bin", "byteLength": 36}],
    }
    (folder / "m.gltf").write_text(json.dumps(content))
    with pytest.raises(AssetError, match="outside"):
        load(folder / "m.gltf")


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("content", [b"", b"\0" * 200, b"solid", b"glTF\2\0\0\0\xff\xff\xff\xff", b"v nan nan nan\n"])
def test_broken_files_are_refused(tmp_path: Path, suffix: str, content: bytes) -> None:
    path = tmp_path / f"broken.{suffix}"
    path.write_bytes(content)
    with pytest.raises(AssetError, match="broken"):
        load(path)


def test_coordinates_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "far.obj"
    path.write_text("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(AssetError, match="finite"):
        load(path)


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck), deadline=None)
@given(data=st.data())
@pytest.mark.parametrize("suffix", FORMATS)
def test_damaged_files_are_refused_or_read(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    content = bytearray(brick(tmp_path / f"whole.{suffix}").read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / f"damaged.{suffix}"
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    try:
        library = load(path)
    except AssetError:
        return
    for node in library.nodes():
        assert all(math.isfinite(number) for number in (*node.location, *node.rotation_euler, *node.scale))
        if node.mesh is not None:
            assert np.isfinite(node.mesh.vertices).all()
            assert node.mesh.triangles.size == 0 or node.mesh.triangles.max() < len(node.mesh.vertices)


# -- colours of robot files are what the programs for these files show: the numbers are those of the screen, sRGB

#: linear light of 0.5 and 0.2, IEC 61966-2-1
HALF, FIFTH = ((0.5 + 0.055) / 1.055) ** 2.4, ((0.2 + 0.055) / 1.055) ** 2.4
BOX = '<visual><geometry><box size="1 1 1"/></geometry>{}</visual>'
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
TEXTS = {
    "shape.xml": '<mujoco><worldbody><body><geom size="1" rgba="0.5 0.2 1 1"/></body></worldbody></mujoco>',
    "material.xml": '<mujoco><asset><material name="m" rgba="0.5 0.2 1 1"/></asset><worldbody><body>'
    '<geom size="1" material="m"/></body></worldbody></mujoco>',
    "robot.urdf": '<robot name="r"><link name="l">'
    + BOX.format('<material name="m"><color rgba="0.5 0.2 1 1"/></material>')
    + "</link></robot>",
    "mesh.urdf": '<robot name="r"><link name="l"><visual><geometry><mesh filename="mesh.obj"/></geometry></visual>'
    "</link></robot>",
    "model.sdf": '<sdf version="1.9"><model name="m"><link name="l"><visual name="v">'
    "<geometry><box><size>1 1 1</size></box></geometry>"
    "<material><diffuse>0.5 0.2 1 1</diffuse></material></visual></link></model></sdf>",
}


@pytest.mark.parametrize("name", TEXTS)
def test_colors_are_those_of_the_screen(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(TEXTS[name])
    (tmp_path / "mesh.obj").write_text(f"mtllib mesh.mtl\n{TRIANGLE}usemtl m\nf 1 2 3\n")
    (tmp_path / "mesh.mtl").write_text("newmtl m\nKd 0.5 0.2 1\n")
    shown = [node for node in load(tmp_path / name).nodes() if node.mesh is not None]
    (node,) = shown
    material = (*node.materials, *node.mesh.materials)[0]
    # files of colours have eight bits
    assert material.color == pytest.approx((HALF, FIFTH, 1.0, 1.0), abs=5e-3)


def test_a_shape_that_glows_is_as_bright_as_in_its_program(tmp_path: Path) -> None:
    file = tmp_path / "lamp.xml"
    file.write_text(TEXTS["material.xml"].replace('name="m" rgba', 'name="m" emission="0.5" rgba'))
    (node,) = (node for node in load(file).nodes() if node.mesh is not None)
    # MuJoCo adds emission times colour, as numbers of the screen
    assert node.materials[0].emission[2] == pytest.approx(HALF)


# -- tGA images: their specification, compared with the PNG as read by Pillow; and malicious files -

#: the corners of an image: red, green above blue, white
CORNERS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
TOP_FIRST, RIGHT_TO_LEFT = 0x20, 0x10


def header(
    width: int, height: int, bits: int, *, kind: int = 2, flags: int = 0, comment: int = 0, colors: int = 0
) -> bytes:
    return struct.pack("<BBB5xHHHHBB", comment, colors, kind, 0, 0, width, height, bits, flags)


def pixels_of(png: bytes) -> np.ndarray:
    with Image.open(io.BytesIO(png)) as picture:
        return np.asarray(picture)


def stored(pixels: np.ndarray) -> bytes:
    """Pixels (H, W, 3 or 4) as blue, green, red and alpha."""
    order = [2, 1, 0, 3][: pixels.shape[2]]
    return pixels[:, :, order].tobytes()


@pytest.mark.parametrize(
    ("flags", "turned"),
    [
        (TOP_FIRST, CORNERS),
        (0, CORNERS[::-1]),
        (TOP_FIRST | RIGHT_TO_LEFT, CORNERS[:, ::-1]),
        (RIGHT_TO_LEFT, CORNERS[::-1, ::-1]),
    ],
)
def test_the_flags_say_where_the_first_pixel_is(flags: int, turned: np.ndarray) -> None:
    data = header(2, 2, 24, flags=flags) + stored(turned)
    np.testing.assert_array_equal(pixels_of(png_of(data)), CORNERS)


def test_the_comment_after_the_header_is_skipped() -> None:
    data = header(2, 2, 24, flags=TOP_FIRST, comment=5) + b"hello" + stored(CORNERS)
    np.testing.assert_array_equal(pixels_of(png_of(data)), CORNERS)


@pytest.mark.parametrize(("flags", "channels"), [(TOP_FIRST | 8, 4), (TOP_FIRST, 3)])
def test_the_fourth_byte_is_alpha_only_if_the_header_says_so(flags: int, channels: int) -> None:
    rgba = np.dstack([CORNERS, np.array([[0, 128], [255, 7]], np.uint8)])
    found = pixels_of(png_of(header(2, 2, 32, flags=flags) + stored(rgba)))
    np.testing.assert_array_equal(found, rgba[:, :, :channels])


def test_runs_and_raw_packets_go_across_rows() -> None:
    red, green, blue = b"\0\0\xff", b"\0\xff\0", b"\xff\0\0"
    body = bytes([0x80 | 3]) + red + bytes([1]) + green + blue
    found = pixels_of(png_of(header(3, 2, 24, kind=10, flags=TOP_FIRST) + body))
    expected = [[[255, 0, 0]] * 3, [[255, 0, 0], [0, 255, 0], [0, 0, 255]]]
    np.testing.assert_array_equal(found, expected)


@settings(deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.sampled_from(["RGB", "RGBA"]), st.booleans(), st.randoms())
def test_files_that_pillow_writes_are_read(width: int, height: int, mode: str, compressed: bool, random) -> None:  # type: ignore[no-untyped-def]
    channels = len(mode)
    values = bytes(random.choice((0, 7, 255)) for _ in range(width * height * channels))
    picture = Image.frombytes(mode, (width, height), values)
    file = io.BytesIO()
    picture.save(file, "TGA", compression="tga_rle" if compressed else None)
    assert is_targa(file.getvalue()[:HEADER_SIZE])
    np.testing.assert_array_equal(pixels_of(png_of(file.getvalue())), np.asarray(picture))


@pytest.mark.parametrize(
    "data",
    [
        b"",
        header(2, 2, 24)[:-1],
        header(2, 2, 24),
        header(2, 2, 24) + b"\0" * 11,
        header(2, 2, 24, comment=255) + stored(CORNERS),
        header(0, 5, 24) + b"\0" * 100,
        header(65535, 65535, 32) + b"\0" * 100,
        header(65535, 65535, 32, kind=10) + b"\xff\0\0\0\0" * 10,
        header(2, 2, 24, kind=10),
        header(2, 2, 24, kind=10) + b"\x83",
        header(2, 2, 24, kind=10) + b"\x84\0\0\0",
        header(2, 2, 24, kind=10) + b"\x7f" + b"\0" * 12,
        header(2, 2, 16) + b"\0" * 100,
        header(2, 2, 8, kind=3) + b"\0" * 100,
        header(2, 2, 24, kind=1, colors=1) + b"\0" * 100,
        header(2, 2, 24, flags=0x40) + b"\0" * 100,
        header(2, 2, 24, flags=8) + b"\0" * 100,
    ],
)
def test_damaged_files_and_other_kinds_are_refused(data: bytes) -> None:
    with pytest.raises(TargaError):
        png_of(data)


@given(st.binary(max_size=200))
def test_no_bytes_raise_anything_else(tail: bytes) -> None:
    for kind in (2, 10):
        with contextlib.suppress(TargaError):
            png_of(header(5, 4, 32, kind=kind, flags=8) + tail)


def test_the_number_of_packets_is_bounded() -> None:
    data = header(8000, 4000, 24, kind=10) + b"\0\1\2\3" * 4_000_000
    with pytest.raises(TargaError, match="packets"):
        png_of(data)
