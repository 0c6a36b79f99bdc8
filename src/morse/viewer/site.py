"""The files of the page and of its world, over HTTP."""

from __future__ import annotations

import gzip
import hashlib
import mimetypes
from dataclasses import dataclass
from functools import cached_property
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from websockets.datastructures import Headers

from morse.core.clients.web_connection import FileResponse
from morse.viewer.description import MeshDescription

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from numpy.typing import NDArray
    from websockets.http11 import Response

    from morse.scene import Image, Mesh


# Meshes in the format of graphics cards.


@dataclass(frozen=True, slots=True)
class PackedMesh:
    """An indexed mesh as bytes, little-endian.

    Attributes:
        data: positions (V, 3) float32, normals (V, 3) float32, texture coordinates (V, 2) float32 if present,
            indices (I,) uint32.
        vertices: V.
        indices: I.
        textured: whether it has texture coordinates.
        groups: (first index, number of indices, material slot), in the order of the indices.
    """

    data: bytes
    vertices: int
    indices: int
    textured: bool
    groups: tuple[tuple[int, int, int], ...]

    def positions(self) -> NDArray[np.float32]:
        """Return the positions (V, 3), m."""
        return np.frombuffer(self.data, "<f4", 3 * self.vertices).reshape(-1, 3)


def pack_mesh(mesh: Mesh) -> PackedMesh:
    """Merge corners with equal position, normal and texture coordinates, and sort triangles by material."""
    order = np.argsort(mesh.material_index, kind="stable")
    triangles = mesh.triangles[order]
    corners = mesh.vertices[triangles].astype(np.float32)
    normals = _face_normals(corners) if mesh.normals is None else mesh.normals[order].astype(np.float32)
    parts = [corners.reshape(-1, 3), normals.reshape(-1, 3)]
    if mesh.uvs is not None:
        parts.append(mesh.uvs[order].astype(np.float32).reshape(-1, 2))
    rows = np.nan_to_num(np.concatenate(parts, axis=1)) + np.float32(0.0)  # the sum converts -0 to 0
    first, indices = _distinct(rows)
    rows = rows[first]
    columns = [rows[:, :3], rows[:, 3:6]] + ([rows[:, 6:8]] if mesh.uvs is not None else [])
    data = b"".join(np.ascontiguousarray(column, dtype="<f4").tobytes() for column in columns)
    return PackedMesh(
        data=data + indices.astype("<u4").tobytes(),
        vertices=len(rows),
        indices=len(indices),
        textured=mesh.uvs is not None,
        groups=_groups(mesh.material_index[order]),
    )


def _face_normals(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """(T, 3, 3) flat normals: equal for all corners of a triangle; +Z for triangles without area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    flat = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), np.array([0.0, 0.0, 1.0]))
    return np.repeat(flat[:, None, :], 3, axis=1).astype(np.float32)


def _distinct(rows: NDArray[np.float32]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first index of each distinct row, and for every row the index of its distinct row."""
    words = np.ascontiguousarray(rows).view(np.uint32).astype(np.uint64)
    factors = np.random.default_rng(1).integers(1, 2**63, size=words.shape[1], dtype=np.uint64) | np.uint64(1)
    hashes = words * factors
    hashes ^= hashes >> np.uint64(29)
    # sorting one number per row is an order of magnitude faster than sorting rows
    _, first, inverse = np.unique(hashes.sum(axis=1, dtype=np.uint64), return_index=True, return_inverse=True)
    if not np.array_equal(rows[first][inverse], rows):
        _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, inverse.reshape(-1)


def _groups(slots: NDArray[np.int32]) -> tuple[tuple[int, int, int], ...]:
    if len(slots) == 0:
        return ()
    starts = np.flatnonzero(np.diff(slots, prepend=slots[0] - 1))
    ends = np.append(starts[1:], len(slots))
    return tuple((int(a) * 3, int(b - a) * 3, int(slots[a])) for a, b in zip(starts, ends, strict=True))


# Geometry and images that pages fetch over HTTP, addressed by a hash of their content.


class AssetStore:
    """Caches of described content, so that only new content of a changed scene is processed."""

    def __init__(self) -> None:
        self._new: dict[str, tuple[str, bytes]] = {}
        # keeps objects alive, so that their ids are not reused
        self._meshes: dict[int, tuple[Mesh, MeshDescription]] = {}
        self._geometry: dict[bytes, MeshDescription] = {}
        self._images: dict[int, tuple[Image, str]] = {}

    def add_meshes(self, meshes: Iterable[Mesh]) -> None:
        """Pack the new meshes into one file."""
        new = {id(mesh): mesh for mesh in meshes if id(mesh) not in self._meshes}
        digests: list[tuple[Mesh, bytes]] = []
        unknown: dict[bytes, PackedMesh] = {}
        for mesh in new.values():
            data = pack_mesh(mesh)
            digest = _digest(data.data + repr(data.groups).encode())
            digests.append((mesh, digest))
            if digest not in self._geometry:
                unknown[digest] = data
        if unknown:
            url = self._store("application/octet-stream", b"".join(data.data for data in unknown.values()))
            offset = 0
            for digest, data in unknown.items():
                self._geometry[digest] = _described(data, url, offset)
                offset += len(data.data)
        for mesh, digest in digests:
            self._meshes[id(mesh)] = (mesh, self._geometry[digest])

    def mesh(self, mesh: Mesh) -> MeshDescription:
        """The description of a mesh that was added; equal for meshes of equal content."""
        return self._meshes[id(mesh)][1]

    def image(self, image: Image) -> str:
        """The address of an image."""
        if id(image) not in self._images:
            self._images[id(image)] = (image, self._store(image.mime, image.data))
        return self._images[id(image)][1]

    def take_new(self) -> dict[str, tuple[str, bytes]]:
        """Content type and bytes of the content added since the last call, by address."""
        new, self._new = self._new, {}
        return new

    def _store(self, mime: str, data: bytes) -> str:
        url = f"/files/{_digest(data).hex()}"
        self._new[url] = (mime, data)
        return url


def _digest(data: bytes) -> bytes:
    return hashlib.sha256(data).digest()[:16]


def _described(part: PackedMesh, url: str, offset: int) -> MeshDescription:
    return MeshDescription(
        url=url,
        offset=offset,
        vertices=part.vertices,
        indices=part.indices,
        textured=part.textured,
        groups=part.groups,
    )


STATIC = Path(__file__).parent / "static"

_POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; "
    # a notebook on this machine may show the page
    "frame-ancestors 'self' http://localhost:* http://127.0.0.1:*"
)
_SECURITY = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
_NOT_BUILT = """<!doctype html><meta charset="utf-8"><title>MORSE</title>
<p>The live view is not part of this installation: it was built without it.
<p>Build it with <code>pip install .</code> in MORSE's sources, on a machine with access to the npm registry.
"""
_COMPRESSIBLE = ("text/", "application/javascript", "application/json", "application/octet-stream", "image/svg")
_COMPRESS_FROM = 2048


class File:
    """A file for HTTP requests.

    Attributes:
        lasting: the content at this address never changes.
    """

    def __init__(self, mime: str, data: bytes, *, lasting: bool) -> None:
        self.mime = mime
        self.data = data
        self.lasting = lasting

    @cached_property
    def tag(self) -> str:
        """A hash of the content."""
        return f'"{hashlib.sha256(self.data).hexdigest()[:24]}"'

    @cached_property
    def compressed(self) -> bytes | None:
        """The content, compressed by gzip if it saves space."""
        if not self.mime.startswith(_COMPRESSIBLE) or len(self.data) < _COMPRESS_FROM:
            return None
        return gzip.compress(self.data, compresslevel=4, mtime=0)


class Site:
    """All files of one server.

    Attributes:
        files: by path.

    Args:
        folder: folder with the files of the page.
        origins: origins of other pages that may fetch the files, and show the page in a frame.
    """

    def __init__(self, folder: Path = STATIC, origins: Collection[str] = ()) -> None:
        self.files: dict[str, File] = {}
        self._origins = frozenset(origins)
        self._policy = " ".join([_POLICY, *sorted(origins)])
        for path in sorted(folder.rglob("*")) if folder.is_dir() else ():
            name = path.relative_to(folder).as_posix()
            if path.is_file() and not name.startswith("."):
                mime = mimetypes.guess_type(name)[0] or "application/octet-stream"
                self.files[f"/{name}"] = File(mime, path.read_bytes(), lasting=name.startswith("assets/"))
        index = self.files.get("/index.html")
        self.files["/"] = index or File("text/html", _NOT_BUILT.encode(), lasting=False)
        self._public = {path for path in self.files if path.startswith("/assets/")}

    def is_secret(self, path: str) -> bool:
        """Whether a token is needed for a path (without query)."""
        return path not in self._public

    def respond(self, path: str, headers: Mapping[str, str], extra: Mapping[str, str]) -> Response:
        """The response to a request for a path (without query)."""
        file = self.files.get(path)
        if file is None:
            return refuse(HTTPStatus.NOT_FOUND, f"There is no {path} here.")
        caching = "private, max-age=31536000, immutable" if file.lasting else "no-cache"
        fields = {"ETag": file.tag, "Cache-Control": caching, "Vary": "Accept-Encoding, Origin", **extra}
        fields["Content-Security-Policy"] = self._policy
        origin = headers.get("Origin", "").lower()
        if origin in self._origins:
            fields["Access-Control-Allow-Origin"] = origin
        if headers.get("If-None-Match") == file.tag:
            return _response(HTTPStatus.NOT_MODIFIED, b"", fields)
        data = file.data
        if "gzip" in headers.get("Accept-Encoding", "") and file.compressed is not None:
            data = file.compressed
            fields["Content-Encoding"] = "gzip"
        charset = "; charset=utf-8" if file.mime.startswith("text/") else ""
        return _response(HTTPStatus.OK, data, {"Content-Type": file.mime + charset, **fields})


def refuse(status: HTTPStatus, why: str) -> Response:
    """An error response with a reason."""
    return _response(status, f"{why}\n".encode(), {"Content-Type": "text/plain; charset=utf-8"})


def _response(status: HTTPStatus, body: bytes, fields: Mapping[str, str]) -> Response:
    headers = Headers({"Content-Length": str(len(body)), "Connection": "close", **_SECURITY, **fields})
    return FileResponse(status.value, status.phrase, headers, body)
