"""Collections of objects, and their instances."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.loader import instantiate
from morse.mathutils import Matrix
from morse.plugins.blend.file import datablock_name
from morse.scene.frames import set_free

if TYPE_CHECKING:
    from morse.plugins.blend.file import BlendFile, Record
    from morse.plugins.blend.objects import Objects
    from morse.scene import Node


class Collections:
    """The groups and collections of a file, and the objects of its first scene.

    Attributes:
        records: address to collection.
    """

    def __init__(self, file: BlendFile) -> None:
        self._file = file
        self._members: dict[int, list[int]] = {}
        self.records: dict[int, Record] = {}
        for struct in ("Group", "Collection"):
            for record in file.datablocks("GR", struct):
                self.records[record.block.address] = record

    def members(self, record: Record) -> list[int]:
        """Addresses of the objects of a collection and of those inside it, each once."""
        key = record.offset
        if key not in self._members:
            addresses: dict[int, None] = {}
            visited: set[int] = set()
            queue = [record]
            while queue:
                current = queue.pop()
                if current.offset in visited:
                    continue
                visited.add(current.offset)
                for struct in ("GroupObject", "CollectionObject"):
                    addresses.update((entry.integer("ob"), None) for entry in current.chain("gobject", struct))
                inner = [
                    entry.follow("collection", "Collection") for entry in current.chain("children", "CollectionChild")
                ]
                queue.extend(collection for collection in reversed(inner) if collection is not None)
            self._members[key] = [address for address in addresses if address]
        return self._members[key]

    def scene_objects(self, scene: Record | None) -> list[int]:
        """Return the addresses of the objects of a scene, including hidden objects."""
        if scene is None:
            return []
        addresses = [entry.integer("object") for entry in scene.chain("base", "Base")]
        if scene.integer("master_collection", 0):
            master = scene.follow("master_collection", "Collection")
            if master is not None:
                addresses += self.members(master)
        return list(dict.fromkeys(address for address in addresses if address))

    def by_name(self, names: dict[int, str]) -> dict[str, list[str]]:
        """Return the names of the objects of each collection, by name of the collection.

        Args:
            names: names of the objects by address.
        """
        return {
            datablock_name(record): [names[address] for address in self.members(record) if address in names]
            for record in self.records.values()
        }


_COLLECTION = 1 << 8
#: maximum nesting depth of collection instances
_MAX_DEPTH = 16
#: maximum number of copies in one file
_MAX_NODES = 20_000


class Instances:
    """Copies the objects of collections to the empties that show them."""

    def __init__(self, file: BlendFile, objects: Objects, collections: Collections) -> None:
        self._file = file
        self._objects = objects
        self._collections = collections
        self._addresses = {node: address for address, node in objects.nodes.items()}
        self._names = {node.name for node in objects.nodes.values()}
        self._suffixes: dict[str, int] = {}
        self._count = 0

    def expand(self) -> list[Node]:
        """Add the copies to the nodes that show them.

        Returns:
            Copies that are dynamic bodies. They become root nodes, because all nodes below a dynamic body move with it.
        """
        # all copies are made from the content of the file before the first one is attached
        visible_instances = [(node, self._shown(node, ())) for node in self._addresses]
        loose: list[Node] = []
        for node, copies in visible_instances:
            for copy in copies:
                if node.parent is None and copy.body.moves:
                    set_free(copy, node.world_matrix() @ copy.local_matrix())
                    loose.append(copy)
                else:
                    _hang(copy, node)
        return loose

    def _shown(self, node: Node, path: tuple[int, ...]) -> list[Node]:
        """Return copies of the objects of the collection that a node shows, with poses relative to the node."""
        collection = self._collection(self._objects.records[self._addresses[node]])
        if collection is None:
            return []
        name, address = datablock_name(collection), collection.block.address
        if address in path or len(path) >= _MAX_DEPTH:
            self._file.warn(f"the collection '{name}' contains an instance of itself, which is ignored")
            return []
        origin = collection.reals(collection.either("dupli_ofs", "instance_offset"), (0.0, 0.0, 0.0))
        offset = Matrix.Translation([-x for x in origin])
        addresses = self._collections.members(collection)
        members = {self._objects.nodes[member]: None for member in addresses if member in self._objects.nodes}
        copies: list[Node] = []
        for member in members:
            if member.parent in members:
                continue
            if self._count > _MAX_NODES:
                self._file.warn(
                    f"the instances of collections contain more than {_MAX_NODES} objects; "
                    "the remaining objects are ignored"
                )
                break
            copies.append(self._copy(member, members, (*path, address)))
            above = Matrix() if member.parent is None else member.parent.world_matrix()
            own = Matrix() if member.parent_inverse is None else member.parent_inverse
            copies[-1].parent_inverse = offset @ above @ own
        return copies

    def _collection(self, record: Record) -> Record | None:
        """The collection that an object shows."""
        field = record.either("dup_group", "instance_collection")
        if not record.has(field) or not record.integer("transflag", 0) & _COLLECTION:
            return None
        return self._collections.records.get(record.integer(field))

    def _copy(self, top: Node, members: dict[Node, None], path: tuple[int, ...]) -> Node:
        """Return a copy of a node and of the nodes below it that also belong to the collection."""
        copy = instantiate(top)
        for original, double in zip(list(top.walk()), list(copy.walk()), strict=True):
            if original not in members:
                double.detach()
                continue
            double.name = self._unique(original.name)
            self._count += 1
            for inner in self._shown(original, path):
                _hang(inner, double)
        return copy

    def _unique(self, name: str) -> str:
        while True:
            number = self._suffixes[name] = self._suffixes.get(name, 0) + 1
            candidate = f"{name}.{number:03d}"
            if candidate not in self._names:
                self._names.add(candidate)
                return candidate


def _hang(child: Node, parent: Node) -> None:
    """Make a copy a child with the pose that it has relative to its parent."""
    child.parent = parent
    parent.children.append(child)
