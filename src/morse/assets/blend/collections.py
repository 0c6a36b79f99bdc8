"""Groups (until 2.79) and collections of objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.blend.record import datablock_name

if TYPE_CHECKING:
    from morse.assets.blend.file import BlendFile
    from morse.assets.blend.record import Record


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
