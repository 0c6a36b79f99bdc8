"""Pictures and shadow maps of many worlds that have the same meshes, each drawn by one thread."""

from __future__ import annotations

import ctypes
from ctypes import c_int32, c_int64, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel import threads
from morse.kernel.drawing.arrays import CHUNK, SEEN, TILE, Pictures
from morse.kernel.drawing.native import MOST_CHUNKS, FrameStructure, NativeKept
from morse.kernel.loading import library
from morse.kernel.memory import address, aligned

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Light
    from morse.kernel.drawing.native import NativeDrawer

#: kinds of `World`
PICTURE, MAP_FROM_AFAR, MAP_FROM_NEAR = range(3)
#: least number of members of tiles for which a thread has memory
_FEWEST_MEMBERS = 4096

#: what is kept of the picture before: a structure, its address, and whether it is empty
Memory = tuple[NativeKept, int, bool]


class _World(ctypes.Structure):
    """``World`` of ``c/draw_worlds.c``."""

    _fields_ = (("frame", FrameStructure), ("bounds", c_void_p), ("kind", c_int32), ("fresh", c_int32))


_WORLD: np.dtype[np.void] = np.dtype(_World)  # type: ignore[assignment]
_MEMORY = (
    *("jobs", "found", "starts", "counts", "chunks", "shares", "seen", "bounds", "firsts", "members", "tiles"),
    *("drawn", "rectangles", "ids"),
)


class _Workspace(ctypes.Structure):
    """``Workspace`` of ``c/draw_worlds.c``."""

    _fields_ = (
        *[(name, c_void_p) for name in _MEMORY],
        *[(name, c_int64) for name in ("member_room", "first", "end", "begun")],
    )


class Worlds:
    """W pictures or shadow maps of instances of the meshes of one drawer.

    Args:
        drawer: has the meshes and materials.
        count: W.
        light: what all of them have: see `Light`.
        samples: see `NativeDrawer.draw`.

    Attributes:
        rows: (W,) ``World`` of ``c/draw_worlds.c``; addresses are numbers.
    """

    def __init__(self, drawer: NativeDrawer, count: int, light: Light, samples: int) -> None:
        template = _World()
        ctypes.memmove(
            ctypes.addressof(template), ctypes.addressof(drawer.frame_of(light, samples)), ctypes.sizeof(FrameStructure)
        )
        self.rows: NDArray[np.void] = np.frombuffer(bytes(template) * count, _WORLD).copy()
        self._frames = self.rows["frame"]
        self._frames["camera_count"] = 1
        self._triangles = drawer.drawing.clusters[:, 3]
        self._most = dict.fromkeys(("parts", "tiles", "triangles", "texels"), 0)
        #: what the rows point to
        self._memory: list[object] = []

    def set(self, of: NDArray[np.integer] | None = None, **arrays: NDArray[np.generic]) -> None:
        """Let each row point to an element of some arrays along their first axis: that with its number, or `of`."""
        for name, array in arrays.items():
            self._memory.append(array)
            self._frames[name] = (address(array) or 0) + array.strides[0] * (
                np.arange(len(array)) if of is None else of
            )

    def set_parts(self, parts: Sequence[NDArray[np.int32]]) -> None:
        """Set the parts (P, 4) of each row."""
        self._memory.extend(parts)
        known: dict[int, tuple[int | None, int]] = {}
        for own in parts:
            if id(own) not in known:
                known[id(own)] = address(own), len(own)
                self._at_least(parts=len(own), triangles=int(self._triangles[own[:, 0]].sum()))
        self._frames["parts"] = [known[id(own)][0] or 0 for own in parts]
        self._frames["part_count"] = [len(own) for own in parts]

    def set_cameras(self, cameras: NDArray[np.void]) -> None:
        """Set the camera (W,) `CAMERA` of each row."""
        cameras["tile"] = cameras["pixel"] = 0
        self.set(cameras=cameras)
        tiles = -(-cameras["width"] // TILE) * -(-cameras["height"] // TILE)
        self._frames["tile_count"] = tiles
        self._at_least(tiles=int(tiles.max()), texels=int((cameras["width"] * cameras["height"]).max()))

    def set_pictures(self, cameras: NDArray[np.void], *, color: bool) -> list[Pictures]:
        """Return the memory into which the pictures of cameras are drawn; without colours, none for these."""
        sizes = (cameras["width"] * cameras["height"]).astype(np.int64)
        ends = np.cumsum(sizes)
        total = int(ends[-1])
        rgba = np.empty((total if color else 0, 4), np.uint8)
        depth, ids, none = np.empty(total, np.float32), np.empty(total, np.int32), np.empty((0, 3), np.float32)
        arrays: tuple[tuple[str, NDArray[Any]], ...] = ("rgba", rgba), ("depth", depth), ("ids", ids)
        for name, array in arrays:
            self._memory.append(array)
            self._frames[name] = (address(array) or 0) + array.strides[0] * (ends - sizes) if len(array) else 0
        parts = [slice(end - size, end) for end, size in zip(ends.tolist(), sizes.tolist(), strict=True)]
        return [Pictures(rgba[part] if color else rgba, depth[part], ids[part], none) for part in parts]

    def set_maps(self, texels: NDArray[np.integer], width: NDArray[np.integer], height: NDArray[np.integer]) -> None:
        """Set the addresses and the sizes of the shadow maps of directional lights, of each row."""
        self._frames["shadow"], self._frames["shadow_width"], self._frames["shadow_height"] = texels, width, height

    def set_depths(self, texels: NDArray[np.integer]) -> None:
        """Set the addresses of the shadow maps of spots, of each row."""
        self._frames["depth"] = texels

    def set_memories(self, memories: Sequence[Memory | None]) -> None:
        """Set what is kept of the picture before in the chain of each row, and whether it is of another camera."""
        pointers = np.array([0 if one is None else one[1] for one in memories], np.uintp)
        self._memory += [pointers, memories]
        at = (address(pointers) or 0) + pointers.itemsize * np.arange(len(pointers))
        self._frames["kept"] = np.where(pointers != 0, at, 0)
        self.rows["fresh"] = [one is not None and one[2] for one in memories]

    def _at_least(self, **numbers: int) -> None:
        for name, number in numbers.items():
            self._most[name] = max(self._most[name], number)

    def draw(self, chains: Sequence[int] | NDArray[np.integer]) -> None:
        """Draw all rows.

        Args:
            chains: the first row of each chain, and the number of rows; the rows of a chain are drawn in their order.
        """
        function, rows = library().morse_draw_worlds, c_void_p(address(self.rows))
        function.restype = c_int64
        firsts, following = np.array(chains, np.int64), np.zeros(1, np.int64)
        count, at, first = c_int64(len(firsts) - 1), c_void_p(address(following)), c_void_p(address(firsts))

        def work() -> None:
            try:
                space = _spare.pop()
            except IndexError:
                space = _Space()
            space.fit(**self._most)
            while missing := function(rows, first, count, at, ctypes.byref(space.structure)):
                space.add_members(missing)
            _spare.append(space)

        threads.together(work, len(firsts) - 1)


class _Space:
    """The memory that a thread needs for a picture."""

    def __init__(self) -> None:
        self.structure = _Workspace()
        self._sizes = dict.fromkeys(("parts", "tiles", "triangles", "texels"), -1)
        self._arrays: dict[str, NDArray[np.generic]] = {}
        self.add_members(_FEWEST_MEMBERS)

    def fit(self, parts: int, tiles: int, triangles: int, texels: int) -> None:
        """Have memory for that many of them."""
        self.structure.first = self.structure.end = self.structure.begun = 0
        wanted = {"parts": parts, "tiles": tiles, "triangles": triangles, "texels": texels}
        if all(self._sizes[name] >= number for name, number in wanted.items()):
            return
        self._sizes = {name: max(self._sizes[name], number) for name, number in wanted.items()}
        # one more than needed: an empty array has no address
        parts, tiles, triangles, texels = (self._sizes[name] + 1 for name in wanted)
        self._set(
            jobs=np.empty((parts, 2), np.int32),
            found=np.empty((parts, 2), np.int32),
            starts=np.empty(parts, np.int64),
            counts=np.empty(parts, np.int64),
            chunks=np.empty(MOST_CHUNKS, CHUNK),
            shares=np.empty(MOST_CHUNKS * tiles, np.int32),
            seen=aligned(triangles, SEEN),
            bounds=np.empty((triangles, 4), np.int16),
            firsts=np.empty(tiles + 1, np.int64),
            tiles=np.empty((tiles, 4), np.int32),
            drawn=np.empty(tiles, np.uint8),
            rectangles=np.empty((parts, 4), np.int32),
            ids=np.empty(texels, np.int32),
        )

    def add_members(self, count: int) -> None:
        """Have memory for that many members of tiles, and for some more."""
        self.structure.member_room = count * 5 // 4
        self._set(members=np.empty(count * 5 // 4, np.int32))

    def _set(self, **arrays: NDArray[np.generic]) -> None:
        self._arrays.update(arrays)
        for name, array in arrays.items():
            setattr(self.structure, name, address(array))


#: those that no thread uses at present
_spare: list[_Space] = []


class Chain:
    """What is kept of the pictures of a purpose, one after the other, of one drawer."""

    def __init__(self, owner: NativeDrawer) -> None:
        self._owner, self._kept = owner, NativeKept(owner)
        #: of the last picture, and of what is kept
        self._last: object = None
        self._complete: object = None

    def follow(
        self, keys: Sequence[object], cameras: NDArray[np.void], instances: int, lights: NDArray[np.void] | None
    ) -> list[Memory | None]:
        """Return what is kept for each of the next pictures: the structure, its address, and whether it is empty.

        Args:
            keys: of each picture: all that it depends on besides the poses and the shadow maps of the classic look.
            cameras: (K,) `CAMERA` of the pictures.
            instances: number of poses.
            lights: an array with the lights of all pictures.
        """
        memories: list[Memory | None] = []
        for number, key in enumerate(keys):
            # a picture of another camera is kept only if the next one is of this camera, too
            wanted = key == self._last or (number + 1 < len(keys) and keys[number + 1] == key)
            self._last = key
            if not wanted:
                memories.append(None)
                continue
            fresh = key != self._complete
            if fresh and self._complete is not None:
                # those before may be of another size, and are drawn later
                self._kept = NativeKept(self._owner)
            self._complete = key
            memories.append((self._kept, self._kept.room(cameras[number], instances), fresh))
            self._kept.hold(lights)
        return memories
