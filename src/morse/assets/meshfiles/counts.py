"""Refuses mesh files that would take excessive time or memory, before they are read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.meshfiles.gltf_counts import check_gltf
from morse.assets.triangle_limit import MOST_MATERIALS, check_corners, check_parts, check_triangles

if TYPE_CHECKING:
    from pathlib import Path

    from morse.assets.meshfiles.files import Below

#: lines of OBJ files that begin an object, a group or a material; faces; vertices
_OBJ_PARTS = re.compile(rb"^[ \t]*(?:o|g|usemtl)[ \t]", re.MULTILINE)
_OBJ_MATERIALS = re.compile(rb"^[ \t]*usemtl[ \t]+(.*)$", re.MULTILINE)
_OBJ_FACES = re.compile(rb"^[ \t]*f[ \t].*$", re.MULTILINE)
_OBJ_VERTICES = re.compile(rb"^[ \t]*v[ \t]", re.MULTILINE)
#: maximum product of the parts of an OBJ file and its vertices: the reader marks for each part which it uses
_MOST_MARKS = 300_000_000
#: bytes of the header of a PLY file, and elements that it defines
_PLY_HEADER, _PLY_ELEMENTS = 1 << 16, 100
_PLY_ELEMENT = re.compile(rb"^[^\S\n]*element[^\S\n]+(\S+)[^\S\n]+(\d+)[^\S\n]*$", re.MULTILINE)


def check_counts(path: Path, below: Below) -> None:
    """Check the counts of a glTF, OBJ or PLY file.

    Args:
        below: reads the files that it refers to.

    Raises:
        AssetError: there are too many parts, triangles or corners, or an array is too large.
    """
    suffix = path.suffix.lower()
    if suffix == ".obj":
        _check_obj(path, path.read_bytes())
    elif suffix == ".ply":
        with path.open("rb") as file:
            _check_ply(path, file.read(_PLY_HEADER), path.stat().st_size)
    elif suffix in (".gltf", ".glb"):
        check_gltf(path, below)


def _check_obj(path: Path, text: bytes) -> None:
    text = text.replace(b"\r\n", b"\n").replace(b"\\\n", b"")
    parts = sum(1 for _ in _OBJ_PARTS.finditer(text))
    check_parts(path, parts, "objects, groups and materials")
    check_parts(path, len(set(_OBJ_MATERIALS.findall(text))), "materials", MOST_MATERIALS)
    vertices = sum(1 for _ in _OBJ_VERTICES.finditer(text))
    if parts * vertices > _MOST_MARKS:
        raise AssetError(
            path, f"its {parts:,} objects, groups and materials share {vertices:,} vertices: join some of the parts, "
            "or divide the file",
        )  # fmt: skip
    triangles = 0
    for face in _OBJ_FACES.finditer(text):
        corners = len(face[0].split()) - 1
        check_corners(path, corners)
        triangles += max(corners - 2, 0)
    check_triangles(path, [triangles])


def _check_ply(path: Path, header: bytes, size: int) -> None:
    begin, end, _ = header.partition(b"end_header")
    if not end:
        raise AssetError(path, f"its header does not end within {_PLY_HEADER} bytes")
    elements = _PLY_ELEMENT.findall(begin)
    if len(elements) > _PLY_ELEMENTS:
        raise AssetError(path, f"its header defines {len(elements)} elements, at most {_PLY_ELEMENTS} can be read")
    for name, number in elements:
        # an element takes a byte at least
        if int(number[:20]) > size:
            element_name = name.decode("ascii", "replace")
            raise AssetError(
                path, f"its header states {int(number[:20]):,} of '{element_name:.40}', its size is {size:,} bytes"
            )
        if name == b"face":
            check_triangles(path, [int(number)])
