"""Damaged, truncated and malicious files: an error with a clear message, within a short time."""

import contextlib
import gzip
import math
import os
import random
import struct
import time
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import zstandard
from blend_writer import IDENTITY, BlendWriter
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from morse.assets.errors import AssetError
from morse.plugins.blend import BlendError, read_blend
from morse.plugins.blend.container import load
from morse.plugins.blend.file import BlendFile
from morse.scene import Library
from tests.kit.effort import examples

pytestmark = pytest.mark.long

FILES = Path(__file__).with_name("files")
SECONDS = 5.0
SQUARE = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (0.0, 1.0, 0.0)]


def scene_writer(**layout: object) -> BlendWriter:
    """A file with many features of old versions."""
    writer = BlendWriter(**layout)
    image, material = writer.address(), writer.address()
    packed = writer.data(image, "PackedFile", {"size": 9, "data": writer.data(image, None, b"\x89PNG\r\n\x1a\n.")})
    writer.datablock("IM", "Image", "image", image, packedfile=packed, source=1)
    texture = writer.datablock("TE", "Tex", "texture", type=8, ima=image)
    slots = [writer.data(material, "MTex", {"mapto": 1, "tex": texture})]
    writer.datablock("MA", "Material", "paint", material, mtex=slots)
    mesh = writer.mesh("mesh", SQUARE, [(1, 2, 3, 0), (0, 1, 2, 3)], materials=(material,), shading=[(0, 1), (0, 1)])
    thing, group, other = writer.address(), writer.address(), writer.address()
    writer.object(
        "thing", mesh, 1, thing, gameflag=1 << 16, prop=writer.game_properties(thing, a=1, b="text", c=0.5),
        id={"properties": writer.property_group(thing, d="text", e=1.5, f=2)},
    )  # fmt: skip
    writer.object("other", mesh, 1, other, parent=thing)
    members = writer.chain(group, "GroupObject", [{"ob": thing}, {"ob": other}])
    writer.datablock("GR", "Group", "group", group, gobject=members)
    shower = writer.object("shower", transflag=1 << 8, dup_group=group)
    writer.scene(thing, shower)
    return writer


@cache
def samples() -> list[bytes]:
    return [
        scene_writer().finish(),
        scene_writer(pointer_size=8, endian=">").finish(),
        load(FILES / "scene-4.5.blend"),
        load(FILES / "scene-5.2.blend"),
    ]


def read(folder: Path, data: bytes) -> Library | None:
    """Read bytes; the library must be valid, an error must be of the documented type, and both within a short time."""
    path = folder / "hostile.blend"
    path.write_bytes(data)
    begin = time.thread_time()
    library = None
    with contextlib.suppress(BlendError):
        library = read_blend(path, blender="no-such-program")
    assert time.thread_time() - begin < SECONDS
    if library is not None:
        check(library)
    return library


def check(library: Library) -> None:
    nodes = library.nodes()
    assert len(nodes) == len({id(node) for node in nodes})
    for node in nodes:
        assert all(math.isfinite(value) for row in node.world_matrix() for value in row)
        assert math.isfinite(node.body.mass)
        assert node.body.mass > 0
        if node.mesh is not None:
            triangles, count = node.mesh.triangles, len(node.mesh.vertices)
            assert np.isfinite(node.mesh.vertices).all()
            assert triangles.size == 0 or (triangles.min() >= 0 and triangles.max() < count)
            slots = max(len(node.mesh.materials), 1)
            assert node.mesh.material_index.size == 0 or node.mesh.material_index.max() < slots
            assert node.mesh.uvs is None or np.isfinite(node.mesh.uvs).all()
            assert node.mesh.normals is None or np.isfinite(node.mesh.normals).all()


def test_the_samples_are_whole(tmp_path: Path) -> None:
    for data in samples():
        library = read(tmp_path, data)
        assert library is not None
        assert library.warnings == []


_anything = settings(
    max_examples=examples(60),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@_anything
@given(data=st.binary(max_size=400), head=st.sampled_from([b"", b"BLENDER", b"BLENDER-v279", b"BLENDER17-01v0500"]))
def test_any_bytes(tmp_path: Path, data: bytes, head: bytes) -> None:
    assert read(tmp_path, head + data) is None or data


@_anything
@given(sample=st.integers(0, 3), share=st.floats(0.0, 1.0, exclude_max=True))
def test_cut_off(tmp_path: Path, sample: int, share: float) -> None:
    data = samples()[sample]
    # without its last block, the end mark, a file is incomplete
    assert read(tmp_path, data[: int(share * (len(data) - 40))]) is None


@settings(_anything, max_examples=examples(150))
@given(sample=st.integers(0, 3), chance=st.randoms(use_true_random=False), count=st.sampled_from([1, 3, 30, 300]))
def test_changed_bytes(tmp_path: Path, sample: int, chance: random.Random, count: int) -> None:
    data = bytearray(samples()[sample])
    for _ in range(count):
        data[chance.randrange(20, len(data))] = chance.randrange(256)
    read(tmp_path, bytes(data))


NUMBERS = [0, 1, -1, 255, 0x7FFF, 0xFFFF, 2**31 - 1, -(2**31), 2**16, 0x7F800000, 0x7FC00000, 0x501502F9]


@settings(_anything, max_examples=examples(150))
@given(sample=st.integers(0, 3), chance=st.randoms(use_true_random=False), count=st.sampled_from([1, 3, 30, 300]))
def test_changed_numbers(tmp_path: Path, sample: int, chance: random.Random, count: int) -> None:
    data = bytearray(samples()[sample])
    for _ in range(count):
        struct.pack_into("<I", data, chance.randrange(20, len(data) - 4) & ~3, chance.choice(NUMBERS) & 0xFFFFFFFF)
    read(tmp_path, bytes(data))


@settings(_anything, max_examples=examples(80))
@given(sample=st.integers(0, 3), chance=st.randoms(use_true_random=False), size=st.sampled_from([4, 8, 64, 512]))
def test_moved_pieces(tmp_path: Path, sample: int, chance: random.Random, size: int) -> None:
    data = bytearray(samples()[sample])
    for _ in range(5):
        source, target = (chance.randrange(20, len(data) - size) & ~3 for _ in range(2))
        data[target : target + size] = data[source : source + size]
    read(tmp_path, bytes(data))


@cache
def pointers(sample: int) -> tuple[list[int], str]:
    """The offsets of the block addresses in a sample, and their format."""
    data = samples()[sample]
    file = BlendFile(data)
    word = f"{file.endian}{'Q' if file.pointer_size == 8 else 'I'}"
    known = {block.address for block in file.blocks} - {0}
    return [at for at in range(20, len(data) - 8, 4) if struct.unpack_from(word, data, at)[0] in known], word


@settings(_anything, max_examples=examples(150))
@given(sample=st.integers(0, 3), chance=st.randoms(use_true_random=False), count=st.sampled_from([1, 5, 50]))
def test_pointers_to_something_else(tmp_path: Path, sample: int, chance: random.Random, count: int) -> None:
    data = bytearray(samples()[sample])
    places, word = pointers(sample)
    size = struct.calcsize(word)
    for _ in range(count):
        target, source = chance.choice(places), chance.choice(places)
        data[target : target + size] = data[source : source + size]
    read(tmp_path, bytes(data))


@settings(_anything, max_examples=examples(100))
@given(
    values=st.dictionaries(
        st.sampled_from(
            ["loc", "size", "rot", "quat", "rotAxis", "parentinv", "rotAngle", "mass", "damping", "inertia"]
        ),
        st.sampled_from([math.nan, math.inf, -math.inf, 3e38, -3e38, 0.0, -1.0]),
    ),
    mode=st.integers(-3, 9),
)
def test_numbers_that_are_none(tmp_path: Path, values: dict[str, float], mode: int) -> None:
    writer = BlendWriter()
    sizes = {"loc": 3, "size": 3, "rot": 3, "quat": 4, "rotAxis": 3, "parentinv": 16}
    mesh = writer.mesh("mesh", [(math.nan, 0, 0), (math.inf, 0, 0), *SQUARE], [(0, 3, 4), (1, 3, 4), (3, 4, 5)])
    parent = writer.object("parent", parentinv=IDENTITY)
    filled = {name: [value] * sizes[name] if name in sizes else value for name, value in values.items()}
    writer.object("thing", mesh, 1, parent=parent, rotmode=mode, gameflag=1 << 16 | 1 | 1 << 10, **filled)
    library = read(tmp_path, writer.finish())
    assert library is not None
    (node,) = library.roots[0].children
    assert len(node.mesh.triangles) == 1


@pytest.mark.parametrize("field", ["totvert", "totface"])
@pytest.mark.parametrize("count", [-1, 5, 1000, 2**31 - 1])
def test_counts_that_lie_cost_the_mesh_only(tmp_path: Path, field: str, count: int) -> None:
    writer = BlendWriter()
    address = writer.address()
    arrays = {
        "mvert": writer.data(address, "MVert", *({"co": vertex} for vertex in SQUARE)),
        "mface": writer.data(address, "MFace", {"v1": 1, "v2": 2, "v3": 3}),
    }
    writer.datablock("ME", "Mesh", "mesh", address, **{"totvert": 4, "totface": 1, **arrays, field: count})
    writer.object("thing", address, 1)
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert library.nodes()[0].mesh is None
    assert library.warnings[0].startswith("the mesh 'mesh' is damaged and is left out: ")


@pytest.mark.parametrize("index", [-1, 4, 2**31 - 1])
def test_indices_outside_of_the_mesh(tmp_path: Path, index: int) -> None:
    writer = BlendWriter()
    writer.object("thing", writer.mesh("mesh", SQUARE, [(1, 2, index)]), 1)
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert "point outside" in library.warnings[0]


@pytest.mark.parametrize("length", [1, 2, 3, 600])
def test_parents_in_a_circle(tmp_path: Path, length: int) -> None:
    writer = BlendWriter()
    addresses = [writer.address() for _ in range(length)]
    for number, address in enumerate(addresses):
        writer.object(f"o{number}", 0, 0, address, parent=addresses[(number + 1) % length])
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert len(library.nodes()) == length
    assert "its own ancestor" in library.warnings[0]


def test_a_long_chain_of_parents_is_cut(tmp_path: Path) -> None:
    writer = BlendWriter()
    addresses = [writer.address() for _ in range(600)]
    for number, address in enumerate(addresses):
        writer.object(f"o{number}", 0, 0, address, parent=addresses[number + 1] if number < 599 else 0)
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert len(library.nodes()) == 600


def test_scales_that_multiply_beyond_all_bounds(tmp_path: Path) -> None:
    writer = BlendWriter()
    above = 0
    for number in range(60):
        above = writer.object(f"o{number}", parent=above, size=[1e8] * 3, loc=[1e8] * 3)
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert len(library.nodes()) == 60
    assert "too large or not finite" in library.warnings[0]


def test_a_list_without_an_end(tmp_path: Path) -> None:
    writer = BlendWriter()
    thing, first = writer.address(), writer.address()
    writer.data(thing, "bProperty", {"next": first, "name": "a", "type": 1, "data": 3}, address=first)
    writer.object("thing", 0, 0, thing, prop={"first": first, "last": first})
    library = read(tmp_path, writer.finish())
    assert library is not None
    assert library.nodes()[0].properties == {"a": 3}
    assert "is circular" in library.warnings[0]


def test_lists_shared_to_cost_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("morse.plugins.blend.file._MAX_STEPS", 50_000)
    writer = BlendWriter()
    owner = writer.address()
    prop = writer.chain(owner, "bProperty", [{"name": f"p{k}", "type": 1} for k in range(300)])
    writer.object("owner", 0, 0, owner, prop=prop)
    for number in range(300):
        writer.object(f"o{number}", prop=prop)
    path = tmp_path / "hostile.blend"
    path.write_bytes(writer.finish())
    with pytest.raises(BlendError, match="longer than those of any real scene"):
        read_blend(path)


def test_groups_of_properties_that_hold_themselves(tmp_path: Path) -> None:
    writer = BlendWriter()
    thing, group = writer.address(), writer.address()
    inner = writer.chain(thing, "IDProperty", [{"type": 6, "name": "self", "data": {"group": {"first": 0}}}])
    writer.data(thing, "IDProperty", {"type": 6, "name": "self", "data": {"group": {"first": group}}}, address=group)
    writer.object("thing", 0, 0, thing, id={"properties": group})
    assert inner
    assert read(tmp_path, writer.finish()) is not None


def test_names_that_are_no_text(tmp_path: Path) -> None:
    writer = BlendWriter()
    writer.datablock("OB", "Object", "x", id={"name": b"OB\xff\xfe\x00rubbish"}, size=[1.0] * 3, parentinv=IDENTITY)
    library = read(tmp_path, writer.finish())
    assert library is not None
    library.nodes()[0].name.encode()


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "not a .blend file"),
        (b"solid cube", "not a .blend file"),
        (b"BLENDER", "header is damaged"),
        (b"BLENDER17-02v0600" + bytes(100), "newer than this reader"),
        (b"BLENDER-v279", "cut off"),
        (b"BLENDER_v262ENDB" + bytes(20), "description of its structs is missing"),
        (b"\x1f\x8b\x08rubbish", "gzip compression is broken"),
        (gzip.compress(b"BLENDER" * 1000, mtime=0)[:-20], "cut off"),
        (b"\x28\xb5\x2f\xfdrubbish", "zstd compression is broken"),
    ],
)
def test_the_error_says_what_is_wrong(tmp_path: Path, data: bytes, sentence: str) -> None:
    path = tmp_path / "model.blend"
    path.write_bytes(data)
    with pytest.raises(BlendError) as caught:
        read_blend(path)
    assert sentence in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")
    assert caught.value.path == path
    assert isinstance(caught.value, AssetError)


def test_missing_files_and_folders(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_blend(tmp_path / "none.blend")
    with pytest.raises(OSError, match="directory"):
        read_blend(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_does_not_block(tmp_path: Path) -> None:
    path = tmp_path / "pipe.blend"
    os.mkfifo(path)
    with pytest.raises(BlendError, match="regular file"):
        read_blend(path)


@pytest.mark.parametrize("compress", [gzip.compress, zstandard.ZstdCompressor().compress])
def test_compressed_files(tmp_path: Path, compress: object) -> None:
    whole = samples()[0]
    assert read(tmp_path, compress(whole)) is not None
    half = len(whole) // 2
    assert read(tmp_path, compress(whole[:half]) + compress(whole[half:])) is not None


@pytest.mark.parametrize("compress", [gzip.compress, zstandard.ZstdCompressor().compress])
def test_decompression_stops_at_the_limit(tmp_path: Path, compress: object) -> None:
    path = tmp_path / "bomb.blend"
    path.write_bytes(compress(b"BLENDER-v279" + bytes(1 << 24)))
    with pytest.raises(BlendError, match="limit of 4 MiB"):
        read_blend(path, size_limit=4 << 20)


def test_a_bomb_is_known_by_its_ratio(tmp_path: Path) -> None:
    path = tmp_path / "bomb.blend"
    path.write_bytes(zstandard.ZstdCompressor(level=3).compress(b"BLENDER-v279" + bytes(1 << 28)))
    with pytest.raises(BlendError, match="more than 50 times"):
        read_blend(path)


def test_files_beyond_the_limit_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "large.blend"
    path.write_bytes(bytes(2 << 20))
    with pytest.raises(BlendError, match="limit of 1 MiB"):
        read_blend(path, size_limit=1 << 20)
