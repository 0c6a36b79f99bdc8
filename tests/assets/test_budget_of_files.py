"""What a file costs is counted over all of its parts, and pictures are decoded where they cannot do harm."""

import base64
import io
import itertools
import json
import os
import struct
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard
from PIL import Image

from morse.assets.loader import load
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.recording.errors import RecordingError
from morse.recording.mcap import reader, records
from morse.system import regular_files as budget
from morse.system.pictures import MOST_PIXELS, open_picture, orientation_of
from morse.system.workers import Worker

OBJ = "mtllib {0}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"


def saved(kind: str, mode: str = "RGB", side: int = 32, **options: object) -> bytes:
    file = io.BytesIO()
    Image.effect_noise((side, side), 60).convert(mode).save(file, kind, **options)
    return file.getvalue()


def robot(folder: Path, count: int, suffix: str = ".png", kind: str = "PNG") -> Path:
    """A robot with meshes whose pictures have 64 x 64 pixels."""
    for i in range(count):
        (folder / f"{i}{suffix}").write_bytes(saved(kind, side=64))
        (folder / f"{i}.mtl").write_text(f"newmtl a\nmap_Kd {i}{suffix}\n")
        (folder / f"{i}.obj").write_text(OBJ.format(i))
    visuals = "".join(f'<visual><geometry><mesh filename="{i}.obj"/></geometry></visual>' for i in range(count))
    (folder / "r.urdf").write_text(f'<robot name="r"><link name="base">{visuals}</link></robot>')
    return folder / "r.urdf"


def seen(path: Path) -> int:
    """The number of pictures that are not replaced."""
    images = {id(one.image): one.image for node in load(path).nodes() for one in node.materials if one.image}
    return sum(Image.open(io.BytesIO(image.data)).size == (64, 64) for image in images.values())


def test_pictures_of_all_meshes_have_one_budget(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = robot(tmp_path, 6)
    assert seen(path) == 6
    # each is looked at when it is found, and when it is decoded
    monkeypatch.setattr(budget, "MOST_PIXELS", 2 * 3 * 64 * 64)
    path.touch()
    os.utime(path, (1, 1))
    assert seen(path) == 3


def test_all_files_of_a_model_have_one_budget(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = robot(tmp_path, 6)
    monkeypatch.setattr(budget, "MOST_BYTES", 4 * len(saved("PNG", side=64)))
    library = load(path)
    assert any("more than" in warning and "together" in warning for warning in library.warnings)


@pytest.mark.parametrize("kind", ["BMP", "DDS", "GIF", "JPEG", "JPEG2000", "PNG", "PPM", "SGI", "TGA", "TIFF", "WEBP"])
def test_formats_keep_their_pixels(kind: str) -> None:
    data = saved(kind)
    with open_picture(data) as picture, Image.open(io.BytesIO(data)) as expected:
        assert np.array_equal(np.asarray(picture.convert("RGB")), np.asarray(expected.convert("RGB")))


@pytest.mark.parametrize("mode", ["L", "I;16", "I", "F", "P", "1", "CMYK"])
def test_heights_keep_their_numbers(mode: str) -> None:
    file = io.BytesIO()
    source = Image.fromarray(np.arange(64, dtype=np.uint8).reshape(8, 8)).convert("I" if mode == "I;16" else mode)
    source.convert(mode).save(file, "TIFF")
    with open_picture(file.getvalue()) as picture:
        if mode == "CMYK":
            assert picture.mode == "RGB"
        else:
            assert np.array_equal(np.asarray(picture), np.asarray(source.convert(mode)))


def test_pictures_that_programs_write_are_no_bombs() -> None:
    for options in ({"progressive": True}, {"progressive": True, "quality": 100}, {}):
        with open_picture(saved("JPEG", side=2048, **options)) as picture:
            picture.load()


def test_pictures_within_a_gltf_are_decoded_by_the_process_as_well(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes() + np.zeros((3, 2), "<f4").tobytes()
    for kind, suffix in itertools.product(("WEBP", "PNG", "TIFF"), (".gltf", ".glb")):
        picture = saved(kind, side=64)
        content = corners + picture + bytes(-len(picture) % 4)
        tree: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}], "images": [{"bufferView": 2}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
            "bufferViews": [{"buffer": 0, "byteOffset": begin, "byteLength": size}
                            for begin, size in ((0, 36), (36, 24), (60, len(picture)))],
            "buffers": [{"byteLength": len(content)}],
        }  # fmt: skip
        path = tmp_path / f"{kind}{suffix}"
        if suffix == ".gltf":
            tree["buffers"][0]["uri"] = f"data:;base64,{base64.b64encode(content).decode()}"
            path.write_text(json.dumps(tree))
        else:
            text = json.dumps(tree).encode()
            text += b" " * (-len(text) % 4)
            size = 28 + len(text) + len(content)
            head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
            path.write_bytes(head + text + struct.pack("<I4s", len(content), b"BIN\0") + content)
        assert seen(path) == 1


def test_one_process_decodes_the_pictures_of_a_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started = []
    start = Worker.program
    monkeypatch.setattr(Worker, "program", lambda *a, **k: started.append(start(*a, **k)) or started[-1])
    assert seen(robot(tmp_path, 4, ".bmp", "BMP")) == 4
    (only,) = started
    with pytest.raises(ProcessLookupError):
        os.kill(only.pid, 0)


def test_a_decoder_that_takes_too_long_is_stopped_and_the_next_picture_is_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "sleeping.py"
    program.write_text("import time\ntime.sleep(600)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(str(tmp_path))
    decoder = budget._DECODER
    monkeypatch.setattr(budget, "_DECODER", "sleeping")
    monkeypatch.setattr(budget, "PATIENCE", 0.5)
    with budget.budget_of_file():
        begin = time.monotonic()
        with pytest.raises(ValueError, match=r"takes more than 0\.5 s"):
            open_picture(saved("BMP"))
        assert time.monotonic() - begin < 60.0
        monkeypatch.setattr(budget, "_DECODER", decoder)
        monkeypatch.setattr(budget, "PATIENCE", 60.0)
        open_picture(saved("BMP"))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("orientation", [1, 3, 6, 8])
def test_the_orientation_is_that_of_the_exif_data(order: str, orientation: int) -> None:
    exif = Image.Exif()
    exif.endian = order
    exif[0x0112] = orientation
    exif[0x010E] = "a picture"
    with open_picture(saved("JPEG", exif=exif.tobytes())) as picture:
        assert orientation_of(picture) == orientation == picture.getexif()[0x0112]


@pytest.mark.parametrize("cut", [0, 3, 7, 9, 12, 20])
def test_exif_data_that_are_cut_off_have_no_orientation(cut: int) -> None:
    picture = Image.new("L", (2, 2))
    picture.info["exif"] = b"Exif\0\0MM\0*\0\0\0\x08\0\x02\x01\x12\0\x03\0\0\0\x01\0\x06\0\0"[: 6 + cut]
    assert orientation_of(picture) == 1


def test_sizes_are_refused_before_decoding() -> None:
    head = struct.pack(">4sIIBBBBB", b"IHDR", 1 << 15, 1 << 15, 8, 0, 0, 0, 0)
    with pytest.raises(ValueError, match=f"32768 x 32768 pixels, more than {MOST_PIXELS}"):
        open_picture(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + bytes(4))


def test_what_chunks_grow_to_is_limited_in_sum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = records.record(0x7F, bytes(1 << 20))
    packed = zstandard.compress(plain)
    chunk = records.chunk_head(0, 1, len(plain), "zstd", len(packed)) + packed
    path = tmp_path / "a.mcap"
    path.write_bytes(records.MAGIC + records.header("", "") + chunk * 20)
    monkeypatch.setattr(reader, "_RATIO", 1)
    monkeypatch.setattr(reader, "_MOST_PLAIN", 30 << 20)
    with reader.McapFile(path) as file:
        # a chunk counts once
        for _ in range(3):
            assert list(file) == []
    monkeypatch.setattr(reader, "_MOST_PLAIN", 10 << 20)
    with reader.McapFile(path) as file, pytest.raises(RecordingError, match="would grow to more than"):
        list(file)


def test_a_package_that_is_a_pipe_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "robot").mkdir()
    os.mkfifo(tmp_path / "package.xml")
    os.mkfifo(tmp_path / "robot" / "package.xml")
    with pytest.raises(FileRefusedError):
        find_near("package://other/a.stl", tmp_path / "robot" / "r.urdf")
