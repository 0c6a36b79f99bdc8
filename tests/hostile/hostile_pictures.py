"""Pictures and .blend files that ask for much more memory than their size suggests."""

import base64
import gzip
import io
import json
import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import zstandard
from hostile_meshes import gltf, late, soup, text
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "plugins" / "blend"))

from blend_writer import BlendWriter
from hostile_meshes import Maker


def png(width: int, height: int, level: int = 9) -> bytes:
    """A black picture; 8192² take 65 kB."""
    packer = zlib.compressobj(level)
    row = bytes(1 + 3 * width)
    data = b"".join([*(packer.compress(row) for _ in range(height)), packer.flush()])
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", data), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in chunks
    )


def _painted(folder: Path, count: int, pictures: Callable[[int], str]) -> Path:
    """An OBJ file with many materials."""
    names = [f"m{i}" for i in range(count)]
    (folder / "a.mtl").write_text("".join(f"newmtl m{i}\nmap_Kd {pictures(i)}\n" for i in range(count)))
    faces = "".join(f"usemtl {name}\nf 1/1 2/2 3/3\n" for name in names)
    content = f"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n{faces}"
    return text(".obj", content)(folder)


def _one_picture(size: int, count: int) -> Maker:
    def make(folder: Path) -> Path:
        (folder / "a.png").write_bytes(png(size, size))
        return _painted(folder, count, lambda i: "a.png")

    return make


def _many_pictures(size: int, count: int) -> Maker:
    def make(folder: Path) -> Path:
        content = png(size, size)
        for number in range(count):
            # equal pixels in different files
            (folder / f"a{number}.png").write_bytes(content + bytes([number]))
        return _painted(folder, count, lambda i: f"a{i}.png")

    return make


def _painted_gltf(picture: bytes, images: int, materials: int) -> dict[str, Any]:
    uris = [f"data:image/png;base64,{base64.b64encode(picture + bytes([i])).decode()}" for i in range(images)]
    return gltf(
        images=[{"uri": uri} for uri in uris],
        textures=[{"source": i % images} for i in range(materials)],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(materials)],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": i} for i in range(materials)]}],
    )


def _textured_ply(folder: Path) -> Path:
    (folder / "a.png").write_bytes(png(8000, 8000))
    head = "ply\nformat ascii 1.0\n" + "comment TextureFile a.png\n" * 1000
    body = (
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
    )
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    return text(".ply", f"{head}{body}{faces}0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n")(folder)


def _textured(suffix: str, content: Callable[[], bytes], count: int = 1) -> Maker:
    """An OBJ file with pictures of a format."""

    def make(folder: Path) -> Path:
        data = content()
        for number in range(count):
            (folder / f"a{number}{suffix}").write_bytes(data + bytes([number]))
        return _painted(folder, count, lambda i: f"a{i}{suffix}")

    return make


def _saved(kind: str, width: int, height: int, mode: str = "L", **options: Any) -> bytes:
    file = io.BytesIO()
    Image.new(mode, (width, height)).save(file, kind, **options)
    return file.getvalue()


def _scans(count: int, side: int) -> bytes:
    """A progressive JPEG file whose last scan is there very often."""
    data = _saved("JPEG", side, side, progressive=True)
    return data[:-2] + data[data.rindex(b"\xff\xda") : -2] * count + data[-2:]


def _segments(count: int, content: bytes) -> bytes:
    """A JPEG file with parts for applications."""
    data = _saved("JPEG", 16, 16)
    return data[:2] + (b"\xff\xe1" + struct.pack(">H", len(content) + 2) + content) * count + data[2:]


def _tags(count: int, size: int) -> bytes:
    """A TIFF directory whose tags all have the same content."""
    begin = 8 + 2 + 12 * count + 4
    tags = b"".join(struct.pack("<HHII", 256 + i, 7, size, begin) for i in range(count))
    return b"II*\0" + struct.pack("<IH", 8, count) + tags + bytes(4 + size)


def _overlapping_tags() -> bytes:
    pixels = struct.pack("<HHII", 256, 4, 1, 16) + struct.pack("<HHII", 257, 4, 1, 16)
    whole = _tags(60_000, 1 << 20)
    return whole[:10] + pixels + whole[10 + len(pixels) :]


def _comments(count: int) -> bytes:
    """A GIF file with many comments before its pixels."""
    data = _saved("GIF", 16, 16)
    place = 13 + 3 * (2 << (data[10] & 7)) if data[10] & 0x80 else 13
    return data[:place] + (b"\x21\xfe\xff" + b"c" * 255 + b"\0") * count + data[place:]


def _parts(count: int) -> bytes:
    """A PNG file of empty parts."""
    data = png(16, 16)
    empty = struct.pack(">I", 0) + b"IDAT" + struct.pack(">I", zlib.crc32(b"IDAT"))
    return data[:33] + empty * count + data[33:]


def _glossy(picture: bytes) -> dict[str, Any]:
    tree = _painted_gltf(picture, 1, 1)
    textures = {"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 0}}
    tree["materials"][0]["extensions"] = {"KHR_materials_pbrSpecularGlossiness": textures}
    return tree


def _inside_gltf(picture: Callable[[], bytes]) -> Maker:
    return late(".gltf", lambda: json.dumps(_painted_gltf(picture(), 1, 1)))


def _objects(count: int) -> bytes:
    writer = BlendWriter()
    mesh = writer.mesh("mesh", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    writer.scene(*(writer.object(f"o{i}", mesh, 1) for i in range(count)))
    return writer.finish()


def _triangles(count: int) -> bytes:
    writer = BlendWriter()
    points = soup(count).reshape(-1, 3).tolist()
    mesh = writer.mesh("mesh", points, [(i, i + 1, i + 2) for i in range(0, 3 * count, 3)])
    writer.scene(writer.object("o", mesh, 1))
    return writer.finish()


def _equal_triangles(count: int) -> bytes:
    writer = BlendWriter()
    mesh = writer.mesh("mesh", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)] * count)
    writer.scene(writer.object("o", mesh, 1))
    return writer.finish()


def _polygon(corners: int) -> bytes:
    writer = BlendWriter()
    address = writer.address()
    points = writer.data(address, "MVert", *({"co": p} for p in [(0, 0, 0), (1, 0, 0), (0, 1, 0)]))
    loops = writer.data(address, "MLoop", struct.pack("<6i", 0, 0, 1, 0, 2, 0) * (corners // 3))
    polygons = writer.data(address, "MPoly", {"loopstart": 0, "totloop": corners // 3 * 3})
    mesh = writer.datablock(
        "ME", "Mesh", "mesh", address, totvert=3, totpoly=1, totloop=corners // 3 * 3, mvert=points, mpoly=polygons,
        mloop=loops,
    )  # fmt: skip
    writer.scene(writer.object("o", mesh, 1))
    return writer.finish()


def _collections(depth: int, width: int) -> bytes:
    """Collections that each contain several instances of the next one."""
    writer = BlendWriter()
    mesh = writer.mesh("mesh", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    groups = [writer.address() for _ in range(depth)]
    shown = []
    for level, group in enumerate(groups):
        inside = groups[level + 1] if level + 1 < depth else 0
        members = [
            writer.object(f"o{level}_{i}", transflag=1 << 8, dup_group=inside)
            if inside
            else writer.object(f"o{level}_{i}", mesh, 1)
            for i in range(width)
        ]
        shown += members
        chain = writer.chain(group, "GroupObject", [{"ob": member} for member in members])
        writer.datablock("GR", "Group", f"g{level}", group, gobject=chain)
    writer.scene(writer.object("top", transflag=1 << 8, dup_group=groups[0]), *shown)
    return writer.finish()


def _packed_pictures(count: int, picture: bytes = b"") -> bytes:
    writer = BlendWriter()
    picture = picture or png(8000, 8000)
    slots = []
    for number in range(count):
        image, material = writer.address(), writer.address()
        packed = writer.data(image, "PackedFile", {"size": len(picture), "data": writer.data(image, None, picture)})
        writer.datablock("IM", "Image", f"i{number}", image, packedfile=packed, source=1)
        texture = writer.datablock("TE", "Tex", f"t{number}", type=8, ima=image)
        mapping = writer.data(material, "MTex", {"mapto": 1, "tex": texture})
        slots.append(writer.datablock("MA", "Material", f"m{number}", material, mtex=[mapping]))
    faces = [(0, 1, 2)] * count
    mesh = writer.mesh(
        "mesh", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces, materials=tuple(slots), shading=[(i, 0) for i in range(count)]
    )
    writer.scene(writer.object("o", mesh, 1))
    return writer.finish()


PICTURES: dict[str, Maker] = {
    "picture: 60 materials, one picture": _one_picture(8192, 60),
    "picture: 5,000 materials, one picture": _one_picture(4096, 4900),
    "picture: 40 pictures": _many_pictures(8192, 40),
    "picture: 30,000 x 30,000": _one_picture(30_000, 1),
    "picture: 60 images in a glTF": late(".gltf", lambda: json.dumps(_painted_gltf(png(8192, 8192), 12, 60))),
    "picture: one image of 1,000 materials": late(".gltf", lambda: json.dumps(
        _painted_gltf(png(8192, 8192), 1, 1000))),
    "picture: glTF, 65,000 x 65,000": late(".gltf", lambda: json.dumps(_painted_gltf(
        png(16, 16).replace(struct.pack(">II", 16, 16), struct.pack(">II", 65_000, 65_000)), 4, 4))),
    "picture: PLY that names one 1,000 times": _textured_ply,
    "picture: JPEG of 14,000 scans": _textured(".jpg", lambda: _scans(14_000, 2048)),
    "picture: JPEG of 300 MB of Exif data": _textured(".jpg", lambda: _segments(5000, b"Exif\0\0" + bytes(60_000))),
    "picture: JPEG of 1,000,000 parts": _textured(".jpg", lambda: _segments(1_000_000, b"")),
    "picture: JPEG, tags of Exif that overlap": _textured(".jpg", lambda: _segments(
        1, b"Exif\0\0" + _tags(2500, 35_000))),
    "picture: PNG of 3,000,000 parts": _textured(".png", lambda: _parts(3_000_000)),
    "picture: TIFF of 60 GB of tags": _textured(".tif", _overlapping_tags),
    "picture: GIF of 200,000 comments": _textured(".gif", lambda: _comments(200_000)),
    "picture: JPEG 2000, 10,000 x 10,000": _textured(".png", lambda: _saved("JPEG2000", 10_000, 10_000)),
    "picture: 20 TIFF, 8,000 x 8,000": _textured(
        ".tif", lambda: _saved("TIFF", 8000, 8000, compression="tiff_lzw"), 20),
    "picture: 10 WebP, 8,000 x 8,000": _textured(".webp", lambda: _saved("WEBP", 8000, 8000, "RGB", quality=1), 10),
    "picture: 40 BMP, 8,000 x 8,000": _textured(".bmp", lambda: _saved("BMP", 8000, 8000, "1"), 40),
    "picture: TIFF within a glTF": _inside_gltf(_overlapping_tags),
    "picture: GIF within a glTF": _inside_gltf(lambda: _comments(100_000)),
    "picture: scans within a glTF, glossy": late(".gltf", lambda: json.dumps(_glossy(_scans(14_000, 2048)))),
    "picture: scans within a glTF": _inside_gltf(lambda: _scans(14_000, 2048)),
    "picture: Exif data within a glTF": _inside_gltf(lambda: _segments(500, b"Exif\0\0" + bytes(60_000))),
}  # fmt: skip

BLENDS: dict[str, Maker] = {
    "blend: 8,000 objects of one mesh": late(".blend", lambda: _objects(8000)),
    "blend: random triangles": late(".blend", lambda: _triangles(60_000)),
    "blend: equal triangles": late(".blend", lambda: _equal_triangles(200_000)),
    "blend: polygon of 600,000 corners": late(".blend", lambda: _polygon(600_000)),
    "blend: instances of collections": late(".blend", lambda: _collections(12, 4)),
    "blend: deep instances of collections": late(".blend", lambda: _collections(30, 2)),
    "blend: 50 packed pictures": late(".blend", lambda: _packed_pictures(25)),
    "blend: gzip bomb": late(".blend", lambda: gzip.compress(b"BLENDER_v262" + bytes(2_000_000_000), 1)[:5_000_000]),
    "blend: 190,000 empty gzip parts": late(".blend", lambda: gzip.compress(b"", mtime=0) * 190_000),
    "blend: 1,000,000 empty zstandard frames": late(".blend", lambda: zstandard.compress(b"") * 1_000_000),
    "blend: 3,000,000 skipped zstandard frames": late(
        ".blend", lambda: zstandard.compress(b"B") + b"\x50\x2a\x4d\x18" * 1 + bytes(4)
        + (b"\x50\x2a\x4d\x18" + bytes(4)) * 3_000_000),
    "blend: packed JPEG of 14,000 scans": late(".blend", lambda: _packed_pictures(1, _scans(14_000, 2048))),
    "blend: zstandard bomb": late(".blend", lambda: zstandard.compress(b"BLENDER_v262" + bytes(2_000_000_000))),
}  # fmt: skip
