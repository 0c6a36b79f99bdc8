"""Pictures and .blend files that ask for much more memory than their size suggests."""

from __future__ import annotations

import base64
import gzip
import json
import struct
import sys
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import zstandard
from hostile_meshes import gltf, late, soup, text

sys.path.append(str(Path(__file__).parents[1] / "assets" / "blend"))
from blend_writer import BlendWriter

if TYPE_CHECKING:
    from collections.abc import Callable

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


def _packed_pictures(count: int) -> bytes:
    writer = BlendWriter()
    picture = png(8000, 8000)
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
    "blend: zstandard bomb": late(".blend", lambda: zstandard.compress(b"BLENDER_v262" + bytes(2_000_000_000))),
}  # fmt: skip
