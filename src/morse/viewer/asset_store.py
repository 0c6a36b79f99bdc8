"""Geometry and images that pages fetch over HTTP, addressed by a hash of their content."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from morse.viewer.description import MeshDescription
from morse.viewer.geometry import pack_mesh

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Image, Mesh
    from morse.viewer.geometry import PackedMesh


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
