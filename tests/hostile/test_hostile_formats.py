"""Pictures in formats that Pillow reads by running a program, or whose readers raise unusual errors."""

import base64
import io
import json
import stat
import struct
from pathlib import Path

import numpy as np
import pytest
from hostile_pictures import png
from PIL import Image as Pillow

from morse.assets.meshfiles.reader import read_meshes
from morse.assets.pictures import usable_picture
from morse.core.exceptions import MorseRPCInvokationError
from morse.rendering.textures import TextureStore
from morse.scene import Image
from morse.simulation.handles.world_changes import NamedPictures
from morse.system.pictures import open_picture

POSTSCRIPT = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n%%EOF\n"


@pytest.fixture
def traps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that a stand-in of Ghostscript writes when it is run."""
    mark = tmp_path / "mark"
    program = tmp_path / "bin" / "gs"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\ntouch {mark}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(program.parent), prepend=":")
    return mark


def _unusual() -> list[bytes]:
    """Damaged files whose readers raise NotImplementedError and RuntimeError."""
    file = io.BytesIO()
    Pillow.new("RGB", (8, 8)).save(file, "DDS")
    flags = bytearray(file.getvalue())
    flags[80:84] = bytes(4)
    return [bytes(flags), b"", POSTSCRIPT, png(9, 9)[:40], struct.pack("<3sI", b"BM", 1 << 31)]


def test_postscript_is_no_texture(traps: Path) -> None:
    with pytest.raises(ValueError, match="unknown format"):
        open_picture(POSTSCRIPT)
    with pytest.raises(ValueError, match="unknown format"):
        usable_picture(POSTSCRIPT)
    TextureStore().number(Image("a.png", POSTSCRIPT, "image/png"))
    assert not traps.exists()


def test_postscript_within_a_mesh_is_replaced(tmp_path: Path, traps: Path) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32).tobytes() + np.zeros((3, 2), np.float32).tobytes()
    content = corners + POSTSCRIPT
    model = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [
            {
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
                # the reader of meshes decodes these pictures itself
                "extensions": {
                    "KHR_materials_pbrSpecularGlossiness": {
                        "diffuseTexture": {"index": 0},
                        "specularGlossinessTexture": {"index": 0},
                    }
                },
            }
        ],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 2, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            {"buffer": 0, "byteOffset": 60, "byteLength": len(POSTSCRIPT)},
        ],
        "buffers": [
            {
                "uri": "data:application/octet-stream;base64," + base64.b64encode(content).decode(),
                "byteLength": len(content),
            }
        ],
    }
    file = tmp_path / "model.gltf"
    file.write_text(json.dumps(model))
    library = read_meshes(file)
    assert not traps.exists()
    assert any("chequered" in warning for warning in library.warnings)


@pytest.mark.parametrize("number", range(len(_unusual())))
def test_cameras_see_a_pattern_in_place_of_a_damaged_picture(number: int) -> None:
    store = TextureStore()
    assert store.number(Image("a.png", _unusual()[number], "image/png")) == 0
    assert store.arrays()[1]["width"][0] == 16


def test_a_texture_that_a_client_names_is_refused_by_its_path(tmp_path: Path) -> None:
    textures = NamedPictures(lambda: [tmp_path])
    for number, data in enumerate([*_unusual(), png(40_000, 1)[:33] + b"\0" * 9]):
        file = tmp_path / f"{number}.png"
        file.write_bytes(data)
        with pytest.raises(MorseRPCInvokationError, match=file.name):
            textures.image(file.name)
