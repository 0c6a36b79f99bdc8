"""Images rendered by the C functions."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel import threads
from morse.kernel.drawing.arrays import (
    CHUNK,
    ENCODED,
    MOST_SHADOWS,
    PLAIN_CODES,
    SAMPLES,
    SEEN,
    TILE,
    Pictures,
    Poses,
    bytes_of_cameras,
    number_tiles,
)
from morse.kernel.loading import library
from morse.kernel.memory import address, aligned, pointer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Light


#: rectangles of texels of shadow maps
_READS = MOST_SHADOWS
_ARRAYS = ("rgba", "depth", "ids", "normals", "models", "turns", "lamp_shadow", "reads", "lights")
#: what a classic light has of its shadow map, which the kernel compares
_OF_MAPS = ("frame", "width", "height", "shadow", "bounds", "version")


class _Kept(ctypes.Structure):
    """``Kept`` of ``c/drawing.h``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ARRAYS],
        ("change", ctypes.c_int64),
        ("instances", ctypes.c_int32),
        ("is_complete", ctypes.c_int32),
    )


class Lit:
    """Everything that the colours of an image depend on, besides the poses and the camera.

    Attributes:
        key: the numbers.
        classic_lights: those of the classic look, with their maps.
        maps: the arrays that count the changes of the shadow maps.
    """

    def __init__(self, light: Light, samples: int) -> None:
        self.classic_lights = light.classic_lights
        lights = light.classic_lights
        if lights is not None:
            has_map = lights["width"] > 0
            lights = lights.copy()
            for name in _OF_MAPS:
                lights[name] = 0
            lights["width"] = has_map
        arrays = (light.lamps, light.sky, light.sun, light.near_sun, light.lamp_frame, light.classic, lights)
        shape = None if light.lamp_shadow is None else light.lamp_shadow.shape
        self.key = (samples, shape, *(None if array is None else array.tobytes() for array in arrays))
        self.maps = (light.shadow_changes, light.near_changes)
        self.lamp_shadow = light.lamp_shadow
        #: shadow maps whose changes are not counted may have changed
        self.is_known = (light.shadow is None) == (self.maps[0] is None)
        self.is_known &= (light.near_shadow is None) == (self.maps[1] is None)


class NativeKept:
    """The last image of a camera, of one drawer.

    An image is the same as the last one if all of these are: the camera, the lamps, the sky and the samples (`_key`),
    the poses of all instances, and the shadow maps. The kernel compares the poses and the maps tile by tile, the rest
    is compared here. All other data are those of the drawer.

    Images are only kept from the second one of a camera that stands: a camera that moves costs nothing.
    """

    def __init__(self, owner: object) -> None:
        self.owner = owner
        self._key: object = None
        self._maps: tuple[object, ...] = ()
        self._shape: tuple[int, int, bool, bool] | None = None
        self._arrays: dict[str, NDArray[np.generic] | None] = {}
        self._structure = _Kept()

    def begin(self, camera: NDArray[np.void], lit: Lit, instances: int) -> int | None:
        """Return the address of the structure for an image; None if the image is not kept.

        Args:
            camera: (1,) `CAMERA`.
        """
        row = camera.copy()
        row["tile"] = row["pixel"] = 0
        color = bool(row["color"][0])
        key = (bytes_of_cameras(row).tobytes(), lit.key if color else None)
        maps = lit.maps if color else ()
        same = key == self._key and all(one is other for one, other in zip(maps, self._maps, strict=True))
        if not same:
            self._key, self._maps = key, maps
            self._structure.is_complete = 0
            return None
        if color and not lit.is_known:
            return None
        return self.room(camera[0], instances)

    def end(self, lit: Lit) -> None:
        """The image is complete."""
        self._arrays["lamp_shadow"] = lit.lamp_shadow
        self._structure.lamp_shadow = address(lit.lamp_shadow)
        self._arrays["lights"] = lit.classic_lights
        self._structure.lights = address(lit.classic_lights)
        self._structure.is_complete = 1

    def room(self, camera: np.void, instances: int) -> int:
        """Return the address of the structure, with memory for an image."""
        self._make_room(camera, instances)
        return ctypes.addressof(self._structure)

    def hold(self, lights: NDArray[np.void] | None) -> None:
        """Keep the lights of an image whose drawing has set their address."""
        self._arrays["lights"] = lights

    def _make_room(self, camera: np.void, instances: int) -> None:
        width, height = int(camera["width"]), int(camera["height"])
        tiles, pixels = -(-width // TILE) * -(-height // TILE), width * height
        shape = (width, height, bool(camera["color"]), bool(camera["normals"]))
        if self._shape == shape:
            return
        self._shape = shape
        self._arrays = {
            "rgba": np.empty((pixels, 4), np.uint8) if camera["color"] else None,
            "depth": np.empty(pixels, np.float32),
            "ids": np.empty(pixels, np.int32),
            "normals": np.empty((pixels, 3), np.float32) if camera["normals"] else None,
            # one more than needed: an empty array has no address
            "models": np.empty((instances + 1, 12), np.float32),
            "turns": np.empty((instances + 1, 9), np.float32),
            "lamp_shadow": None,
            "reads": np.empty((tiles, _READS, 4), np.int32),
            "lights": None,
        }
        self._structure = _Kept(**{name: address(array) for name, array in self._arrays.items()}, instances=instances)


_ADDRESSES = """vertices triangles clusters spheres parts slots materials maps texels textures lamps sky samples encoded
    closed guards levels
    models turns cameras shadow sun near_shadow near_sun lamp_shadow lamp_frame classic classic_lights
    shadow_bounds near_bounds lamp_bounds shadow_changes near_changes points corners point_counts boxes
    jobs found starts counts chunks shares seen bounds firsts members tiles drawn kept rgba depth ids normals"""
_NUMBERS = """part_count lamp_count sample_count camera_count job_count tile_count shadow_width shadow_height
    near_width near_height lamp_width lamp_height cluster_count chunk_count thread_count"""
_SIZES = "seen_count member_count member_room drawn_count change"
#: four stages of an image, each with four ranges of work of three numbers, and the number of complete pieces
_Stages = ctypes.c_int64 * (4 * (4 * 3 + 1))


class FrameStructure(ctypes.Structure):
    """``Frame``. It holds references to the arrays that it points to."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ADDRESSES.split()],
        *[(name, ctypes.c_int32) for name in _NUMBERS.split()],
        *[(name, ctypes.c_int64) for name in _SIZES.split()],
        ("stages", _Stages),
        ("arrived", ctypes.c_int64),
    )

    def __init__(self) -> None:
        super().__init__()
        self._kept: dict[str, NDArray[np.generic] | None] = {}

    def point(self, **arrays: NDArray[np.generic] | None) -> None:
        """Set addresses to those of contiguous arrays, or to null."""
        memory = self._kept
        for name, array in arrays.items():
            # the memory of an array does not move
            if name not in memory or memory[name] is not array:
                setattr(self, name, address(array))
                memory[name] = array

    def restart(self) -> None:
        """Begin with the first piece of the first stage."""
        self.stages, self.arrived = _Stages(), 0

    def forget(self, *names: str) -> None:
        """Release arrays that the frame points to."""
        self.point(**dict.fromkeys(names))


class _Movers(ctypes.Structure):
    """``Movers`` of ``c/draw_shadow.c``."""

    _fields_ = (
        *[
            (name, ctypes.c_void_p)
            for name in (
                *(
                    "parts",
                    "left_out",
                    "base",
                    "models",
                    "touched",
                    "extents",
                    "again",
                    "changed",
                    "stale",
                    "bounds",
                    "changes",
                ),
            )
        ],
        ("count", ctypes.c_int32),
        ("spare", ctypes.c_int32),
    )


class NativeMovers:
    """The shadows of parts that may move.

    Args:
        parts: (M,) the parts.
        light: with the map, which has the shadows of all other parts already.

    Attributes:
        touched: (M, 4) int32, the texels that each part may fill: x0, y0, x1, y1, one past the end; zeros if the map
            does not show it.
        extents: (M, 4) the same; not zeros for parts whose shadows no camera sees.
    """

    def __init__(self, library: ctypes.CDLL, frame: FrameStructure, parts: NDArray[np.integer], light: Light) -> None:
        shadow, bounds = light.shadow, light.shadow_bounds
        assert shadow is not None
        self._function, self._frame, self._light = library.morse_draw_movers, frame, light
        count = len(parts)
        self.touched = np.zeros((count, 4), np.int32)
        # one more than needed: an empty array has no address
        self.extents = np.zeros((count, 4), np.int32)
        self._left_out = np.zeros(count + 1, np.uint8)
        self._arrays: dict[str, NDArray[np.generic] | None] = {
            "parts": np.append(parts, 0).astype(np.int32),
            "left_out": self._left_out,
            "base": shadow.copy(),
            "models": np.zeros((count + 1, 12), np.float32),
            "touched": self.touched,
            "extents": self.extents,
            "again": np.zeros(count + 1, np.uint8),
            "changed": np.zeros((2 * count + 1, 4), np.int32),
            "stale": None if bounds is None else np.zeros(bounds.shape[:2], np.uint8),
            "bounds": bounds,
            "changes": light.shadow_changes,
        }
        self._movers = _Movers(**{name: address(array) for name, array in self._arrays.items()}, count=count)

    def update(self, poses: Poses, cameras: NDArray[np.void], left_out: NDArray[np.bool_] | None = None) -> None:
        """Draw the shadows of parts that have moved again, if a camera may see them.

        Args:
            cameras: (K,) `CAMERA`.
            left_out: (M,) the parts whose shadows are not needed.
        """
        frame, light = self._frame, self._light
        assert light.shadow is not None
        self._left_out[:-1] = False if left_out is None else left_out
        frame.point(shadow=light.shadow, sun=light.sun, models=poses.models, cameras=cameras)
        frame.camera_count = len(cameras)
        frame.shadow_height, frame.shadow_width = light.shadow.shape
        self._function(ctypes.byref(frame), ctypes.byref(self._movers))
        frame.forget("cameras")


_OF_ONE_CALL = ("cameras", "rgba", "depth", "ids", "normals")
#: the largest number of chunks of a camera; see ``c/draw_find.c``
MOST_CHUNKS = 33
#: the positions of samples
_SAMPLES = {count: np.array(positions, np.float32) for count, positions in SAMPLES.items()}


class _Triangles:
    """Memory for the triangles of a picture, which is needed only while it is drawn: all drawers share it."""

    def __init__(self, count: int) -> None:
        self.seen, self.bounds = aligned(count, SEEN), np.empty((count, 4), np.int16)


#: those that no thread uses at present
_spare: list[_Triangles] = []


class NativeDrawer:
    """Renders images.

    Args:
        like: see `drawer`.

    Attributes:
        drawing: the scene.
        drawn_tiles: number of tiles of the last images that were not taken over from those before.
    """

    def __init__(self, library: ctypes.CDLL, drawing: Drawing, like: NativeDrawer | None = None) -> None:
        self._library = library
        self.drawing = drawing
        self._frame = frame = FrameStructure()
        frame.point(**drawing._asdict(), encoded=ENCODED)
        frame.part_count, frame.cluster_count = len(drawing.parts), len(drawing.clusters)
        if like is None:
            self._points: dict[str, NDArray[np.generic]] = {
                "points": np.empty((len(drawing.vertices) + 1, 3), np.float32),
                "corners": np.empty((len(drawing.triangles) + 1, 3), np.uint16),
                "point_counts": np.empty(len(drawing.clusters) + 1, np.int32),
                "boxes": np.empty((len(drawing.clusters) + 1, 6), np.float32),
            }
            frame.point(**self._points)
            library.morse_draw_points(ctypes.byref(frame))
        else:
            self._points = like._points
            frame.point(**self._points)
        self.drawn_tiles = 0
        self._sizes = (-1, -1)
        self._room: dict[str, NDArray[np.generic]] = {}

    def arrange(
        self,
        parts: NDArray[np.int32],
        slots: NDArray[np.int32] | None = None,
        materials: NDArray[np.void] | None = None,
        maps: NDArray[np.float32] | None = None,
    ) -> None:
        """Draw other instances of the same meshes from now on; see `Drawing`. The arrays are not copied.

        Images that were kept are not those of the new instances.
        """
        same = self.drawing
        self.drawing = same._replace(
            parts=parts,
            slots=same.slots if slots is None else slots,
            materials=same.materials if materials is None else materials,
            maps=same.maps if maps is None else maps,
        )
        frame = self._frame
        now = self.drawing
        frame.point(parts=now.parts, slots=now.slots, materials=now.materials, maps=now.maps)
        if frame.part_count != len(parts):
            frame.part_count, self._sizes = len(parts), (-1, -1)

    def reshape(self, first: int) -> None:
        """Take note of moved vertices of the clusters from a number on; their spheres are changed by the caller."""
        frame, drawing = self._frame, self.drawing
        names = ("point_counts", "boxes")
        frame.point(clusters=drawing.clusters[first:], **{name: self._points[name][first:] for name in names})
        frame.cluster_count = len(drawing.clusters) - first
        self._library.morse_draw_points(ctypes.byref(frame))
        frame.point(clusters=drawing.clusters, **{name: self._points[name] for name in names})
        frame.cluster_count = len(drawing.clusters)

    def draw(
        self, cameras: NDArray[np.void], poses: Poses, light: Light, samples: int, memories: Sequence[Kept | None] = ()
    ) -> Pictures:
        """Render the images of cameras.

        Args:
            cameras: (K,) `CAMERA`; their first tiles and pixels are set.
            samples: number of samples per pixel for the colour: 1 or 5.
            memories: of each camera, so that tiles that do not change are not rendered again; None for none.
        """
        frame, count = self._frame, len(cameras)
        tiles, pixels = number_tiles(cameras)
        self._light(light, poses, samples)
        frame.point(cameras=cameras, **self._room_for(count, tiles))
        frame.camera_count, frame.tile_count = count, tiles
        lit, pointers = self._begin(cameras, memories, poses, light, samples) if memories else (None, [])
        if not memories:
            frame.point(kept=None)
        frame.job_count = self._library.morse_draw_find(ctypes.byref(frame))
        colour = np.empty((pixels if cameras["color"].any() else 0, 4), np.uint8)
        normals = np.empty((pixels if cameras["normals"].any() else 0, 3), np.float32)
        pictures = Pictures(colour, np.empty(pixels, np.float32), np.empty(pixels, np.int32), normals)
        frame.point(**pictures._asdict())
        self._draw(tiles)
        frame.forget(*_OF_ONE_CALL)
        for one in pointers:
            assert lit is not None
            one.end(lit)
        self.drawn_tiles = frame.drawn_count
        return pictures

    def frame_of(self, light: Light, samples: int) -> FrameStructure:
        """Return the structure of the scene with lights, without poses, cameras and pictures."""
        frame, none = self._frame, np.zeros((0, 12), np.float32)
        self._light(light, Poses(none, none), samples)
        frame.forget(*_OF_ONE_CALL, "kept")
        return frame

    def _begin(
        self, cameras: NDArray[np.void], memories: Sequence[Kept | None], poses: Poses, light: Light, samples: int
    ) -> tuple[Lit, list[NativeKept]]:
        """Point to the images of standing cameras that are kept."""
        lit, frame, pointers = Lit(light, samples), self._frame, []
        addresses = np.zeros(len(memories), np.uintp)
        for number, one in enumerate(memories):
            if one is None:
                continue
            if one.of is None or one.of.owner is not self:
                one.of = NativeKept(self)
            place = one.of.begin(cameras[number : number + 1], lit, len(poses.models))
            if place is not None:
                addresses[number] = place
                pointers.append(one.of)
        frame.point(kept=addresses if pointers else None)
        return lit, pointers

    def _room_for(self, cameras: int, tiles: int) -> dict[str, NDArray[np.generic]]:
        """Arrays for that many cameras and tiles; they are kept for the next images."""
        if self._sizes != (cameras, tiles):
            self._sizes, parts = (cameras, tiles), len(self.drawing.parts)
            # one more than needed: an empty array has no address
            jobs = cameras * parts + 1
            self._room = {
                "jobs": np.empty((jobs, 2), np.int32),
                "starts": np.empty(jobs, np.int64),
                "counts": np.empty(jobs, np.int64),
                "found": np.empty((parts + 1, 2), np.int32),
                "chunks": np.empty(MOST_CHUNKS * cameras + 1, CHUNK),
                "shares": np.empty(MOST_CHUNKS * tiles + 1, np.int32),
                "firsts": np.empty(tiles + 1, np.int64),
                "tiles": np.empty((tiles + 1, 4), np.int32),
                "drawn": np.empty(tiles + 1, np.uint8),
            }
        return self._room

    def _draw(self, tiles: int) -> None:
        """Run all stages in several threads."""
        frame, function = self._frame, self._library.morse_draw_picture
        try:
            room = _spare.pop()
        except IndexError:
            room = _Triangles(0)
        if frame.seen_count > len(room.bounds):
            room = _Triangles(frame.seen_count * 5 // 4)
        frame.point(seen=room.seen, bounds=room.bounds)
        frame.restart()
        pieces = min(tiles, frame.drawn_count + 1)
        frame.thread_count = min(threads.count(), pieces)
        threads.together(lambda: function(ctypes.byref(frame)), pieces)
        if frame.member_count > frame.member_room:
            # the kernel goes on where it needed more memory
            frame.member_room = frame.member_count * 5 // 4
            frame.point(members=np.empty(frame.member_room, np.int32))
            threads.together(lambda: function(ctypes.byref(frame)), pieces)
        frame.forget("seen", "bounds")
        _spare.append(room)

    def cast_shadows(self, parts: NDArray[np.integer], poses: Poses, light: Light) -> NDArray[np.int32]:
        """Draw parts into the shadow map.

        Returns:
            (N, 4) the texels that each part may have filled: x0, y0, x1, y1, one past the end.
        """
        frame = self._frame
        if light.shadow_changes is not None:
            frame.change += 1
            light.shadow_changes[:] = frame.change
        self._light(light, poses, 1)
        jobs = np.ascontiguousarray(np.column_stack([np.zeros_like(parts), parts]), dtype=np.int32)
        rectangles = np.zeros((len(parts), 4), np.int32)
        frame.point(jobs=jobs)
        frame.job_count = len(parts)
        self._library.morse_draw_shadow(ctypes.byref(frame), pointer(rectangles))
        frame.forget("jobs")
        return rectangles

    def bound_shadows(self, light: Light) -> None:
        """Set the bounds of all blocks of the shadow map."""
        if light.shadow is not None and light.shadow_bounds is not None:
            self.bound(light.shadow, light.shadow_bounds)

    def bound(self, shadow: NDArray[np.float32], bounds: NDArray[np.float32]) -> None:
        """Set the bounds of all blocks of a shadow map; see `bounds_for`."""
        height, width = shadow.shape
        self._library.morse_draw_bounds(pointer(shadow), width, height, pointer(bounds))

    def moving_shadows(self, parts: NDArray[np.integer], light: Light) -> NativeMovers:
        """Return the shadows of parts that may move, in a map that has the shadows of the others already."""
        return NativeMovers(self._library, self._frame, parts, light)

    def _light(self, light: Light, poses: Poses, samples: int) -> None:
        frame, shadow, near, lamp = self._frame, light.shadow, light.near_shadow, light.lamp_shadow
        frame.point(**light._asdict(), encoded=ENCODED if light.classic is None else PLAIN_CODES)
        frame.point(samples=_SAMPLES[samples], models=poses.models, turns=poses.turns)
        frame.lamp_count, frame.sample_count = len(light.lamps), samples
        frame.shadow_height, frame.shadow_width = (0, 0) if shadow is None else shadow.shape
        frame.near_height, frame.near_width = (0, 0) if near is None else near.shape
        frame.lamp_height, frame.lamp_width = (0, 0) if lamp is None else lamp.shape


def drawer(drawing: Drawing, like: NativeDrawer | None = None) -> NativeDrawer:
    """The renderer.

    Args:
        drawing: the scene.
        like: a renderer of the same vertices, triangles and clusters, with which the new one shares memory.
    """
    return NativeDrawer(library(), drawing, like)


class Kept:
    """The last image of a camera, of which the next image takes over all tiles that are the same.

    The images are those of a renderer that keeps nothing.

    Attributes:
        of: the data of the drawer; None before the first image, and without the kernel.
    """

    __slots__ = ("of",)

    def __init__(self) -> None:
        self.of: NativeKept | None = None
