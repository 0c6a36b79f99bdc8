"""Collision shapes are kept on disk, for the next process."""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.assets import collision, shape_cache
from morse.assets.cache import Cache
from morse.assets.shape_cache import ShapeCache, load_shapes, store_shapes
from morse.assets.solids import cube
from morse.scene import BodySettings, CollisionShape, Mesh, Node, NodeKind, PhysicsType, Scene, ShapeKind
from tests.kit.programs import BESIDE, python

#: a box without its lid: neither a primitive nor convex
_OPEN = cube()
_LEFT = [index for index, corners in enumerate(_OPEN.triangles) if not (_OPEN.vertices[corners, 2] > 0).all()]
_MESH = Mesh("open box", _OPEN.vertices, _OPEN.triangles[_LEFT], _OPEN.material_index[_LEFT])


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The directory of the cache, which is empty at first."""
    monkeypatch.setenv("MORSE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "shapes"


@pytest.fixture
def computed(monkeypatch):
    """One entry for each mesh whose shapes are computed."""
    made = []
    compute = collision._parts
    monkeypatch.setattr(collision, "_parts", lambda *arguments: made.append(1) or compute(*arguments))
    return made


def shapes(monkeypatch, scale=1.0):
    """The shapes of the open box, in a process that has not computed any."""
    monkeypatch.setattr(collision, "_EARLIER", ShapeCache())
    node = Node("solid", NodeKind.MESH, mesh=_MESH, body=BodySettings(type=PhysicsType.STATIC))
    node.scale = (scale, scale, scale)
    collision.resolve_shapes(Scene(roots=[node]))
    assert len(node.shapes) == 5
    return node.shapes


def bits(found):
    """Everything in shapes, exactly."""
    return [
        (one.kind.name, one.size, one.position, one.rotation, None if one.vertices is None else one.vertices.tobytes())
        for one in found
    ]


def extent(found):
    """The largest coordinate of the shapes."""
    return max(
        abs(one.position[axis]) + one.size[axis] if one.vertices is None else abs(one.vertices[:, axis]).max()
        for one in found
        for axis in range(3)
    )  # fmt: skip


def test_the_next_process_reads_the_same_shapes(monkeypatch, computed):
    first = shapes(monkeypatch)
    assert bits(first) == bits(shapes(monkeypatch))
    assert len(computed) == 1
    assert extent(shapes(monkeypatch, scale=2.0)) == pytest.approx(2 * extent(first), rel=0.05)
    assert len(computed) == 2


@pytest.mark.parametrize("damage", [b"", b"rubbish", None])
def test_a_damaged_result_is_computed_again(monkeypatch, computed, folder, damage):
    first = shapes(monkeypatch)
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    broken = bytearray(whole)
    broken[len(whole) // 2] ^= 1
    file.write_bytes(bytes(broken) if damage is None else damage)
    assert bits(first) == bits(shapes(monkeypatch))
    assert len(computed) == 2
    assert file.read_bytes() == whole


def test_results_of_another_version_are_not_used(monkeypatch, computed):
    shapes(monkeypatch)
    monkeypatch.setattr(shape_cache, "_program", lambda: b"another version")
    shapes(monkeypatch)
    assert len(computed) == 2


def test_the_cache_can_be_switched_off(monkeypatch, computed, folder):
    monkeypatch.setenv("MORSE_CACHE", "off")
    shapes(monkeypatch)
    shapes(monkeypatch)
    assert len(computed) == 2
    assert not folder.exists()


def test_a_cache_that_cannot_be_written_does_not_matter(monkeypatch, tmp_path):
    (tmp_path / "file").write_bytes(b"")
    monkeypatch.setenv("MORSE_CACHE", str(tmp_path / "file"))
    shapes(monkeypatch)


def test_the_results_used_least_recently_are_deleted(folder):
    cache = Cache("shapes", most=2)
    for number, key in enumerate("abc"):
        cache.put(key, b"data")
        os.utime(folder / key, (number, number))
    assert cache.get("a") == b"data"  # used again: now the newest
    Cache("shapes", most=2).put("d", b"data")
    assert sorted(entry.name for entry in folder.iterdir()) == ["a", "d"]


def test_a_result_that_is_too_large_is_not_read():
    cache = Cache("shapes", most=2)
    cache.put("a", bytes(100))
    assert cache.get("a", largest=99) is None
    assert cache.get("a", largest=100) == bytes(100)


_NUMBERS = st.floats(-1e6, 1e6)
_VERTICES = st.lists(st.tuples(_NUMBERS, _NUMBERS, _NUMBERS), min_size=1, max_size=5).map(np.array)
_SHAPES = st.builds(
    CollisionShape,
    st.sampled_from(ShapeKind),
    st.lists(_NUMBERS, max_size=3).map(tuple),
    st.tuples(*[_NUMBERS] * 3),
    st.tuples(*[_NUMBERS] * 9),
    st.none() | _VERTICES,
)


@given(st.lists(_SHAPES, max_size=4), st.lists(st.text(), max_size=2))
def test_any_shapes_are_read_as_they_were_written(found, warnings):
    key = b"content", (1.0, 0.0), None
    store_shapes(key, (tuple(found), tuple(warnings)))
    again = load_shapes(key)
    assert again is not None
    assert bits(found) == bits(again[0])
    assert again[1] == tuple(warnings)


def test_shapes_are_the_same_in_another_process(monkeypatch):
    first = shapes(monkeypatch)
    program = BESIDE + (
        "\nimport test_shape_files as t, morse.assets.collision as c, pytest\n"
        "c._parts = None\n"
        "with pytest.MonkeyPatch.context() as patch: print(t.bits(t.shapes(patch)))\n"
    )
    done = python("-c", program, folder=Path(__file__).parent)
    assert done.stdout.strip() == str(bits(first)), done.stderr
