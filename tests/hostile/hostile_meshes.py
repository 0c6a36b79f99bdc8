"""Mesh files that ask for much more work than their size suggests: each function writes files and returns the model."""

import base64
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Maker = Callable[[Path], Path]

_TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
_BASIS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")


def text(suffix: str, content: str | bytes) -> Maker:
    """A maker of a file of the given content."""

    def make(folder: Path) -> Path:
        path = folder / f"hostile{suffix}"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return make


def late(suffix: str, content: Callable[[], str | bytes]) -> Maker:
    """As `text`, for content that takes memory: it is created when the file is written."""
    return lambda folder: text(suffix, content())(folder)


def soup(count: int, seed: int = 1) -> Any:
    """(count, 3, 3) corners of random triangles in a cube."""
    return np.random.default_rng(seed).random((count, 3, 3)).astype("<f4")


def slivers(count: int) -> Any:
    """(count, 3, 3) corners of small triangles that do not touch each other."""
    rng = np.random.default_rng(2)
    return (rng.random((count, 1, 3)) * 10 + rng.random((count, 3, 3)) * 1e-3).astype("<f4")


def fan(count: int) -> Any:
    """(count, 3, 3) corners of triangles that all share one edge."""
    rng = np.random.default_rng(3)
    corners = np.zeros((count, 3, 3), "<f4")
    corners[:, 1] = (1, 0, 0)
    corners[:, 2] = rng.random((count, 3))
    return corners


def waves(side: int) -> Any:
    """Corners of a bumpy closed-edge surface of 2 * side² triangles: nowhere flat."""
    rng = np.random.default_rng(4)
    y, x = np.mgrid[: side + 1, : side + 1].astype("<f4") / side
    points = np.stack([x, y, 0.05 * rng.random(x.shape).astype("<f4")], -1)
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3, 3), np.stack([a, c, d], 2).reshape(-1, 3, 3)])


def same(count: int) -> Any:
    """(count, 3, 3) corners of equal triangles."""
    return np.repeat(_BASIS[None, :3], count, axis=0)


def stl(corners: Any, *, count: int | None = None) -> bytes:
    """A binary STL file; ``count``: the number of triangles that it states."""
    rows = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    rows["corners"] = corners
    return bytes(80) + struct.pack("<I", len(corners) if count is None else count) + rows.tobytes()


def ply(corners: Any, head: str = "") -> bytes:
    """A binary PLY file of separate triangles."""
    count = len(corners)
    rows = np.zeros(count, np.dtype([("size", "u1"), ("corners", "<i4", 3)]))
    rows["size"], rows["corners"] = 3, np.arange(3 * count).reshape(-1, 3)
    return _ply_head(3 * count, count, head) + corners.astype("<f4").tobytes() + rows.tobytes()


def ply_of(triangles: Any, vertices: Any = _BASIS) -> bytes:
    """A binary PLY file of triangles between few vertices."""
    rows = np.zeros(len(triangles), np.dtype([("size", "u1"), ("corners", "<i4", 3)]))
    rows["size"], rows["corners"] = 3, triangles
    return _ply_head(len(vertices), len(triangles)) + np.asarray(vertices, "<f4").tobytes() + rows.tobytes()


def _ply_head(vertices: int, faces: int, more: str = "") -> bytes:
    return (
        f"ply\nformat binary_little_endian 1.0\n{more}element vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()


def obj(corners: Any) -> str:
    """An OBJ file of separate triangles."""
    points = "".join(f"v {x:.5f} {y:.5f} {z:.5f}\n" for x, y, z in corners.reshape(-1, 3).tolist())
    return points + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 3 * len(corners), 3))


def gltf(**changed: Any) -> dict[str, Any]:
    """A triangle as a glTF file, with other or more members."""
    data = base64.b64encode(_BASIS[:3].tobytes() + struct.pack("<3H", 0, 1, 2)).decode()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": f"data:application/octet-stream;base64,{data}", "byteLength": 42}],
        **changed,
    }  # fmt: skip


def glb(tree: dict[str, Any], data: bytes) -> bytes:
    """A binary glTF file."""
    head = json.dumps({**tree, "buffers": [{"byteLength": len(data)}]}).encode()
    head += b" " * (-len(head) % 4)
    chunks = struct.pack("<I4s", len(head), b"JSON") + head + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _glb_of(corners: Any) -> bytes:
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3 * len(corners), "type": "VEC3"}
    view = {"buffer": 0, "byteLength": corners.nbytes}
    return glb(gltf(accessors=[accessor], bufferViews=[view]), corners.tobytes())


def _shared_arrays(uses: int) -> bytes:
    """Many primitives that each refer to all of one array of 100,000 triangles."""
    data = soup(100_000).tobytes()
    accessor = {"bufferView": 0, "componentType": 5126, "count": 300_000, "type": "VEC3"}
    meshes = [{"primitives": [{"attributes": {"POSITION": 0}}] * uses}]
    return glb(gltf(accessors=[accessor], bufferViews=[{"buffer": 0, "byteLength": len(data)}], meshes=meshes), data)


def _overlapping_arrays(count: int) -> bytes:
    """Many arrays that each cover all of the file."""
    data = bytes(3_600_000)
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 300_000, "type": "VEC3"}] * count
    primitive = {"attributes": {"POSITION": 0}}
    meshes = [{"primitives": [primitive]}]
    view = [{"buffer": 0, "byteLength": len(data)}]
    return glb(gltf(accessors=accessors, bufferViews=view, meshes=meshes), data)


def _sparse_buffers(folder: Path) -> Path:
    with (folder / "data.bin").open("wb") as file:
        file.truncate(400_000_000)
    buffers = [{"uri": "data.bin", "byteLength": 400_000_000}] * 40
    return text(".gltf", json.dumps(gltf(buffers=[*gltf()["buffers"], *buffers])))(folder)


def collada(scene: str, *, nodes: str = "", geometry: str = "", unit: str = "1") -> str:
    """A COLLADA file with a triangle ``#g``."""
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>'
        f'<unit meter="{unit}"/><up_axis>Z_UP</up_axis></asset><library_geometries>{geometry or _geometry()}'
        f'</library_geometries><library_nodes>{nodes}</library_nodes><library_visual_scenes><visual_scene id="s">'
        f'{scene}</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    )


def _geometry(primitives: str = '<triangles count="1">{inputs}<p>0 1 2</p></triangles>', points: str = "") -> str:
    points = points or "0 0 0 1 0 0 0 1 0 0 0 1"
    count = len(points.split())
    inputs = '<input semantic="VERTEX" source="#v" offset="0"/>'
    return (
        f'<geometry id="g"><mesh><source id="p"><float_array id="a" count="{count}">{points}</float_array>'
        f'<technique_common><accessor source="#a" count="{count // 3}" stride="3"><param name="X" type="float"/>'
        '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
        '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
        f"{primitives.replace('{inputs}', inputs)}</mesh></geometry>"
    )


USE = '<instance_geometry url="#g"/>'


def doubling(depth: int, uses: int = 2) -> str:
    """COLLADA nodes that each contain the next node several times."""
    nodes = "".join(
        f'<node id="n{i}">' + f'<instance_node url="#n{i + 1}"/>' * uses + "</node>" for i in reversed(range(depth))
    )
    return collada('<node id="top"><instance_node url="#n0"/></node>', nodes=f'<node id="n{depth}">{USE}</node>{nodes}')


def _circle() -> str:
    nodes = '<node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node>'
    return collada('<node id="top"><instance_node url="#a"/></node>', nodes=nodes)


def _collada_of(corners: Any) -> str:
    points = " ".join(f"{x:.4f}" for x in corners.ravel().tolist())
    order = " ".join(map(str, range(3 * len(corners))))
    return collada(
        f'<node id="n">{USE}</node>',
        geometry=_geometry(f'<triangles count="{len(corners)}">{{inputs}}<p>{order}</p></triangles>', points),
    )


MESHES: dict[str, Maker] = {
    # COLLADA
    **{f"collada: instances, depth {depth}": text(".dae", doubling(depth)) for depth in (10, 14, 22, 40, 2000)},
    "collada: 100 instances each": text(".dae", doubling(6, 100)),
    "collada: circle": text(".dae", _circle()),
    "collada: 100,000 instances of a geometry": late(".dae", lambda: collada(f'<node id="n">{USE * 100_000}</node>')),
    "collada: 50,000 nodes": late(".dae", lambda: collada(f"<node>{USE}</node>" * 50_000)),
    "collada: 100,000 empty nodes": late(".dae", lambda: collada("<node/>" * 100_000)),
    "collada: polygon of 1.2 M corners": late(".dae", lambda: collada(
        f"<node>{USE}</node>", geometry=_geometry(
            '<polylist count="1">{inputs}<vcount>1200000</vcount><p>' + "0 1 2 " * 400_000 + "</p></polylist>"))),
    "collada: 300,000 equal triangles": late(".dae", lambda: collada(
        f"<node>{USE}</node>", geometry=_geometry(
            '<triangles count="300000">{inputs}<p>' + "0 1 2 " * 300_000 + "</p></triangles>"))),
    "collada: random triangles": late(".dae", lambda: _collada_of(soup(50_000))),
    "collada: 20,000 primitives": late(".dae", lambda: collada(
        f"<node>{USE}</node>", geometry=_geometry('<triangles count="1">{inputs}<p>0 1 2</p></triangles>' * 20_000))),
    "collada: nested nodes": late(".dae", lambda: collada("<node>" * 90_000 + USE + "</node>" * 90_000)),
    "collada: no scene": text(".dae", collada("").replace('<instance_visual_scene url="#s"/>', "")),
    # glTF
    "gltf: 40 times one sparse file": _sparse_buffers,
    "gltf: 100 uses of one array": late(".glb", lambda: _shared_arrays(100)),
    "gltf: 9,000 uses of one array": late(".glb", lambda: _shared_arrays(9000)),
    "gltf: 5,000 overlapping arrays": late(".glb", lambda: _overlapping_arrays(5000)),
    "gltf: random triangles": late(".glb", lambda: _glb_of(soup(130_000))),
    "gltf: equal triangles": late(".glb", lambda: _glb_of(same(130_000))),
    "gltf: small triangles": late(".glb", lambda: _glb_of(slivers(130_000))),
    "gltf: nodes that share children": text(".gltf", json.dumps(gltf(
        nodes=[*({"children": [i + 1, i + 1]} for i in range(40)), {"mesh": 0}]))),
    "gltf: 10,000 nodes": text(".gltf", json.dumps(gltf(
        nodes=[{"mesh": 0}] * 10_000, scenes=[{"nodes": list(range(10_000))}]))),
    "gltf: chains of nodes": text(".gltf", json.dumps(gltf(
        nodes=[*({} if i % 450 == 449 else {"children": [i + 1]} for i in range(9_899)), {"mesh": 0}]))),
    "gltf: nested lists": text(".gltf", '{"asset":' + "[" * 2_000_000 + "]" * 2_000_000 + "}"),
    "gltf: a million extensions": late(".gltf", lambda: json.dumps(
        gltf(extensionsUsed=["a"] * 900_000))),
    "gltf: matrix of 1e308": text(".gltf", json.dumps(gltf(nodes=[{"mesh": 0, "name": "o", "matrix": [
        1e308 if i % 5 == 0 else 0.0 for i in range(16)]}]))),
    "gltf: 5,000,000 indices of one array": late(".glb", lambda: glb(gltf(
        accessors=[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                   {"bufferView": 1, "componentType": 5121, "count": 4_900_000 // 3 * 3, "type": "SCALAR"}],
        bufferViews=[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 4_900_000}],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    ), _BASIS[:3].tobytes() + bytes([0, 1, 2, 0]) * 1_225_000)),
    # OBJ
    "obj: polygon of 1.2 M corners": late(".obj", lambda: _TRIANGLE + "f" + " 1 2 3" * 400_000 + "\n"),
    "obj: 3 polygons of 400,000 corners": late(".obj", lambda: _TRIANGLE + ("f" + " 1 2 4" * 133_000 + "\n") * 3),
    "obj: 600,000 equal triangles": late(".obj", lambda: _TRIANGLE + "f 1 2 3\n" * 600_000),
    "obj: 600,000 triangles without area": late(".obj", lambda: _TRIANGLE + "f 1 1 1\n" * 600_000),
    "obj: 500,000 quads": late(".obj", lambda: _TRIANGLE + "f 1 2 3 4\n" * 490_000),
    "obj: random triangles": late(".obj", lambda: obj(soup(40_000))),
    "obj: all pairs of corners": late(".obj", lambda: _TRIANGLE + "vt 0 0\nvt 1 0\nvn 0 0 1\nvn 1 0 0\n" + "".join(
        f"f 1/{1 + i % 2}/1 2/{1 + i % 2}/2 3/1/{1 + i % 2}\n" for i in range(230_000))),
    "obj: points only": late(".obj", lambda: "v 0 0 0\n" * 600_000),
    "obj: continued lines": late(".obj", lambda: _TRIANGLE + "f 1 2 \\\n3\n" * 400_000),
    "obj: 200,000 libraries of materials": late(".obj", lambda: "mtllib a.mtl\n" * 350_000 + _TRIANGLE + "f 1 2 3\n"),
    "obj: mixed polygons": late(".obj", lambda: _TRIANGLE + "".join(
        "f" + " 1 2 3" * (1 + i % 97) + "\n" for i in range(16_000))),
    "obj: polygons of other sizes": late(".obj", lambda: _TRIANGLE + "".join(
        "f" + " 1 2 3 4 1"[: 4 + 2 * (i % 4)] + " 2" * (i % 1300) + "\n" for i in range(3_000))),
    # PLY
    "ply: 60,000 empty lines in its header": text(".ply", "ply\nformat ascii 1.0\n" + "\n" * 60_000 + "end_header\n"),
    "ply: 370,000 equal triangles": late(".ply", lambda: ply_of(np.tile([0, 1, 2], (370_000, 1)))),
    "ply: triangles between 4 vertices": late(".ply", lambda: ply_of(
        np.random.default_rng(1).integers(0, 4, (370_000, 3)))),
    "ply: triangles between 300 vertices": late(".ply", lambda: ply_of(
        np.random.default_rng(1).integers(0, 300, (370_000, 3)), soup(100).reshape(-1, 3))),
    "ply: triangles between 30,000 vertices": late(".ply", lambda: ply_of(
        np.random.default_rng(1).integers(0, 30_000, (340_000, 3)), soup(10_000).reshape(-1, 3))),
    "ply: random triangles": late(".ply", lambda: ply(soup(100_000))),
    "ply: one edge": late(".ply", lambda: ply(fan(100_000))),
    "ply: waves": late(".ply", lambda: ply(waves(220))),
    "ply: list of 2^31": text(".ply", _ply_head(3, 1).replace(b"uchar", b"uint") + bytes(36) + b"\xff\xff\xff\x7f"),
    "ply: 4,000,000,000 vertices": text(".ply", _ply_head(4_000_000_000, 1) + bytes(100)),
    "ply: polygon of 1.2 M corners": late(".ply", lambda: _ply_head(4, 1).replace(b"uchar", b"uint") + _BASIS.tobytes()
        + struct.pack("<I", 1_200_000) + np.tile(np.array([0, 1, 2], "<i4"), 400_000).tobytes()),
    "ply: 100,000 elements": late(".ply", lambda: _ply_head(3, 1, "element a 0\nproperty int x\n" * 100_000)),
    "ply: text": late(".ply", lambda: b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        b"property float z\nelement face 600000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
        b"0 1 0\n" + b"3 0 1 2\n" * 600_000),
    # STL
    "stl: wrong count": text(".stl", stl(same(4), count=77)),
    "stl: 4,294,967,295 triangles": text(".stl", stl(same(4), count=0xFFFFFFFF)),
    "stl: equal triangles": late(".stl", lambda: stl(same(100_000))),
    "stl: random triangles": late(".stl", lambda: stl(soup(100_000))),
    "stl: one edge": late(".stl", lambda: stl(fan(100_000))),
    "stl: small triangles": late(".stl", lambda: stl(slivers(100_000))),
    "stl: one point": late(".stl", lambda: stl(np.zeros((100_000, 3, 3), "<f4"))),
    "stl: waves": late(".stl", lambda: stl(waves(220))),
    "stl: 200,000 empty solids": late(".stl", lambda: "solid a\nendsolid a\n" * 200_000),
    "stl: 30,000 solids": late(".stl", lambda: (
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "endsolid a\n") * 30_000),
    "stl: one line": late(".stl", lambda: "solid a " + "facet " * 800_000),
}  # fmt: skip
