"""Objects from a table: names, parents, positions, bounding boxes, physics and semantic tags."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from common.objects import empty, exact, hidden_shape, twin
from common.parts import bounds
from common.shapes import box

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    import bpy

    from common.objects import Triple
    from common.parts import Part

COLLISION = {"BOX": "box", "CYLINDER": "cylinder", "TRIANGLE_MESH": "mesh", "CONVEX_HULL": "convex"}


@dataclass
class Row:
    """One object; metres and radians in the world, the bounding box in the frame of the object."""

    name: str
    parent: str
    at: Triple
    turned: Triple
    size: Triple | None
    centre: Triple | None
    options: dict[str, object] = field(default_factory=dict)


def rows(path: Path) -> Iterator[Row]:
    """The rows of a table with the columns name, parent, xyz, rpy, size, centre, physics, bounds, mass, properties."""
    with path.open(newline="") as file:
        for line in csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE):
            options: dict[str, object] = {"physics_type": line["physics"]}
            if line["bounds"]:
                options["collision"] = COLLISION[line["bounds"]]
            if line["mass"]:
                options["mass"] = float(line["mass"])
            options |= json.loads(line["properties"] or "{}")
            at, turned, size, centre = (
                tuple(float(number) for number in line[key].split()) or None for key in ("xyz", "rpy", "size", "centre")
            )
            yield Row(line["name"], line["parent"], at, turned, size, centre, options)


class Furnisher:
    """Creates the objects of a table; objects with the same appearance and size share a mesh.

    Args:
        looks: returns a word for the appearance of an object, and a function that makes its parts.
        boxes: words of objects that collide as their bounding box unless the table sets another shape: exact shapes of
            many small parts take long to load.
    """

    def __init__(
        self, looks: Callable[[Row], tuple[str, Callable[[], list[Part]]]], boxes: frozenset[str] = frozenset()
    ) -> None:
        self._looks, self._boxes = looks, boxes
        self._made: dict[str, bpy.types.Object] = {}
        self._first: dict[tuple[object, ...], bpy.types.Object] = {}

    def furnish(self, table: list[Row]) -> None:
        """Create everything, parents first."""
        names = {row.name for row in table}
        while table:
            ready = [row for row in table if row.parent not in names or row.parent in self._made]
            for row in ready:
                self._made[row.name] = self._make(row)
            table = [row for row in table if row.name not in self._made]

    def _make(self, row: Row) -> bpy.types.Object:
        parent = self._made.get(row.parent)
        if row.size is None:
            return empty(row.name, row.at, row.turned, parent=parent, **row.options)
        if "collision" in row.name.lower():
            parts = [box(*row.size).moved(*row.centre)]
            options = {"collision": "box", **row.options}
            return hidden_shape(row.name, parts, row.at, row.turned, parent=parent, **options)
        kind, build = self._looks(row)
        if kind in self._boxes:
            row.options.setdefault("collision", "box")
        key = (kind, row.size, row.centre)
        if key in self._first:
            return twin(self._first[key], row.name, row.at, row.turned, parent=parent, **row.options)
        parts = build()
        low, high = bounds(parts)
        middle = (low + high) / 2
        parts = [part.moved(*-middle) for part in parts]
        made = exact(row.name, parts, row.size, row.centre, row.at, row.turned, parent=parent, **row.options)
        self._first[key] = made
        return made
