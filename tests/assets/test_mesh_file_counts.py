"""Mesh files with excessive counts are refused before they take time and memory."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morse.assets.errors import AssetError
from morse.assets.loader import load

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
PART = {"attributes": {"POSITION": 0}}


def gltf(**changed: Any) -> dict[str, Any]:
    """A triangle."""
    data = base64.b64encode(CORNERS).decode()
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [PART]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": f"data:application/octet-stream;base64,{data}", "byteLength": 36}],
        **changed,
    }


def chain(length: int) -> list[dict[str, Any]]:
    return [{"children": [number + 1]} for number in range(length)] + [{"mesh": 0}]


ZEROS = {"componentType": 5126, "count": 2_000_000_000, "type": "VEC3"}
FEW = {"bufferView": 0, **ZEROS, "sparse": {"count": 1}}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"accessors": [ZEROS]}, "2000000000 items that are not in the file"),
        ({"accessors": [FEW]}, "2000000000 items that are not in the file"),
        ({"nodes": [{"mesh": 0}] * 20_000}, "20000 nodes"),
        ({"meshes": [{"primitives": [PART] * 20_000}]}, "20000 meshes"),
        ({"nodes": [{"mesh": 0}] * 200, "meshes": [{"primitives": [PART] * 200}]}, "40000 meshes that its nodes show"),
        ({"nodes": chain(600)}, "nested more than 500 deep"),
    ],
)
def test_a_gltf_with_excessive_counts_is_refused(tmp_path: Path, changed: dict[str, Any], said: str) -> None:
    path = tmp_path / "many.gltf"
    path.write_text(json.dumps(gltf(**changed)))
    with pytest.raises(AssetError, match=said):
        load(path)


def test_the_same_in_a_binary_file(tmp_path: Path) -> None:
    text = json.dumps(gltf(accessors=[ZEROS])).encode()
    path = tmp_path / "many.glb"
    path.write_bytes(struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text)
    with pytest.raises(AssetError, match="items that are not in the file"):
        load(path)


def test_an_obj_with_very_many_parts_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "many.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "o a\nusemtl b\nf 1 2 3\n" * 6000)
    with pytest.raises(AssetError, match="12000 objects, groups and materials"):
        load(path)


def test_usual_counts_are_read(tmp_path: Path) -> None:
    path = tmp_path / "usual.gltf"
    path.write_text(json.dumps(gltf(nodes=chain(30))))
    assert sum(node.mesh is not None for node in load(path).nodes()) == 1
    # a node that is a part of itself has no pose in the scene
    path.write_text(json.dumps(gltf(nodes=[{"mesh": 0, "children": [0]}])))
    with pytest.raises(AssetError, match="part"):
        load(path)
