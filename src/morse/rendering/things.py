"""Groups meshes into objects, and computes bounding boxes of objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from morse.core.world import Body, World
    from morse.scene import Node


class Box(NamedTuple):
    """A box around an object, along the axes of the object.

    Attributes:
        position: (3,) its centre, m, world frame.
        rotation: (3, 3) object to world.
        size: (3,) lengths of its edges, m.
    """

    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    size: NDArray[np.float64]


class Things:
    """The objects that the meshes of an image belong to.

    A mesh belongs to its nearest ancestor, or to itself, that has the property ``tag`` or is a robot; without such a
    node, to the root of its tree.

    Args:
        nodes: nodes of the meshes, as in `Picture.nodes`.
        robots: the nodes of the robots.
        tag: name of the property.

    Attributes:
        nodes: nodes of the objects, in the order of their first meshes.
        numbers: (I,) the object of each mesh, index in ``nodes``.
    """

    def __init__(self, world: World, nodes: Sequence[Node], robots: Collection[Node], tag: str) -> None:
        self._world, self._robots, self._tag = world, robots, tag
        first: dict[Node, int] = {}
        self.numbers = np.array([first.setdefault(self._thing_of(node), len(first)) for node in nodes], np.int32)
        self.nodes = list(first)
        self._members: list[list[Node]] = [[] for _ in first]
        for node, number in zip(nodes, self.numbers.tolist(), strict=True):
            self._members[number].append(node)
        self._fixed: dict[Node, tuple[tuple[object, object], tuple[NDArray[np.float64], NDArray[np.float64]]]] = {}

    def _thing_of(self, node: Node) -> Node:
        top = node
        for above in (node, *node.ancestors()):
            top = above
            obj = self._world.find_object(above)
            if above in self._robots or (obj is not None and obj.get(self._tag)):
                break
        return top

    def box(self, number: int) -> Box | None:
        """The smallest box along the axes of an object that contains all its visible meshes; None if it has none."""
        thing = self._world.find_object(self.nodes[number])
        if thing is None:
            return None
        place, turn = _as_arrays(thing.world_pose())
        extents = [
            self._extent(node, obj, thing, place, turn)
            for node in self._members[number]
            if (obj := self._world.find_object(node)) is not None and obj.visible
        ]
        if not extents:
            return None
        low, high = np.min([e[0] for e in extents], axis=0), np.max([e[1] for e in extents], axis=0)
        return Box(matmul(turn, (low + high) / 2) + place, turn, high - low)

    def _extent(
        self, node: Node, obj: Body, thing: Body, place: NDArray[np.float64], turn: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper corner of a mesh in the frame of its object."""
        if obj.slot != thing.slot:
            here, own = _as_arrays(obj.world_pose())
            return _reach(node, matmul(turn.T, own), matmul(turn.T, here - place))
        # parts of one body do not move relative to each other, unless they are displaced explicitly
        offsets = (obj.offset, thing.offset)
        extent = self._fixed.get(node)
        if extent is None or extent[0] != offsets:
            (here, own), (place, turn) = (_as_arrays(offset) for offset in offsets)
            extent = self._fixed[node] = (
                offsets,
                _reach(node, matmul(turn.T, own), matmul(turn.T, here - place)),
            )
        return extent[1]


def _reach(
    node: Node, rotation: NDArray[np.float64], position: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    assert node.mesh is not None
    stretch = np.array([list(row) for row in rigid_frame(node).stretch])
    points = matmul(np.asarray(node.mesh.vertices, np.float64).reshape(-1, 3), matmul(rotation, stretch).T) + position
    points = points[np.isfinite(points).all(axis=1)]
    return (points.min(axis=0), points.max(axis=0)) if len(points) else (position, position)


def _as_arrays(pose: tuple[object, object]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(3,) and (3, 3) of a position and a rotation, row by row."""
    return np.array(pose[0]), np.reshape(np.array(pose[1]), (3, 3))


class Patch(NamedTuple):
    """The visible part of an object in an image.

    Attributes:
        number: id in the image.
        pixels: number of its pixels.
        box: x0, y0, x1, y1, pixels from the upper left corner; x1 and y1 are one past the last pixel.
    """

    number: int
    pixels: int
    box: tuple[int, int, int, int]


def patches(image: NDArray[np.integer]) -> list[Patch]:
    """The visible objects in an image of ids (H, W), without 0, in the order of the ids."""
    height, width = image.shape
    counts = np.bincount(image.ravel())
    visible_numbers = np.flatnonzero(counts)
    place = np.zeros(len(counts), np.intp)
    place[visible_numbers] = np.arange(len(visible_numbers))
    compact = place[image]
    rows, columns = np.zeros((len(visible_numbers), height), bool), np.zeros((len(visible_numbers), width), bool)
    rows[compact, np.arange(height)[:, None]] = True
    columns[compact, np.arange(width)[None]] = True
    x0, y0 = columns.argmax(axis=1), rows.argmax(axis=1)
    x1, y1 = width - columns[:, ::-1].argmax(axis=1), height - rows[:, ::-1].argmax(axis=1)
    boxes = np.column_stack([x0, y0, x1, y1]).tolist()
    return [
        Patch(number, int(counts[number]), tuple(box))
        for number, box in zip(visible_numbers.tolist(), boxes, strict=True)
        if number
    ]
