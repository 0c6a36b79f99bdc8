"""The largest number of triangles in a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseBuilderError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Mesh, Node

#: collision shapes, rays and images take about 1 kB for each
MOST_TRIANGLES = 10_000_000
#: number of meshes that the message names
_NAMED = 5


class TriangleLimit:
    """Counts the triangles of the meshes of a scene; a mesh that several nodes share counts once."""

    def __init__(self) -> None:
        #: keeps the meshes alive, so that their ids are not reused
        self._meshes: dict[int, Mesh] = {}
        self._count = 0

    def add(self, node: Node, nodes: Iterable[Node]) -> None:
        """Count the mesh of a node.

        Args:
            nodes: all nodes of the scene; they are counted again before an error, because some may have been deleted.

        Raises:
            MorseBuilderError: the meshes have more than `MOST_TRIANGLES`.
        """
        mesh = node.mesh
        if mesh is None or id(mesh) in self._meshes:
            return
        self._meshes[id(mesh)] = mesh
        self._count += len(mesh.triangles)
        if self._count > MOST_TRIANGLES:
            owners = {id(mesh): (mesh, name) for mesh, name in _named(nodes)}
            self._meshes = {key: mesh for key, (mesh, _) in owners.items()}
            self._count = sum(len(mesh.triangles) for mesh in self._meshes.values())
            if self._count > MOST_TRIANGLES:
                raise MorseBuilderError(_message(self._count, [*owners.values()]))


def _named(nodes: Iterable[Node]) -> Iterator[tuple[Mesh, str]]:
    for node in nodes:
        if node.mesh is not None:
            yield node.mesh, node.name


def _message(count: int, owners: list[tuple[Mesh, str]]) -> str:
    owners.sort(key=lambda owner: -len(owner[0].triangles))
    largest = ", ".join(f"'{name}' ({len(mesh.triangles):,})" for mesh, name in owners[:_NAMED])
    return (
        f"the scene has {count:,} triangles, and the limit is {MOST_TRIANGLES:,}; the largest meshes are those of "
        f"{largest}; reduce their triangles, for example with the modifier 'Decimate' of Blender"
    )
