"""The messages and poses of a run, kept for a page that plays them without a server."""

from __future__ import annotations

import gzip
import json
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.viewer.asset_store import AssetStore
from morse.viewer.describe import describe, world_key
from morse.viewer.hub import Wishes
from morse.viewer.protocol import encode_json
from morse.viewer.view_messages import Payload, Picture, World

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.values import JsonObject
    from morse.scene import Scene
    from morse.viewer.snapshot import MovingNode
    from morse.viewer.view_messages import ServerMessage

#: poses are stored as multiples of this, m and without unit
PLACES = 1e-4
_FARTHEST = 2.0e9
#: digits and decimals of the numbers of a message: a millimetre in degrees of latitude, in coordinates of a map, and
#: ten microseconds in times since 1970; half of the digits of JSON
_DIGITS, _DECIMALS = 10, 5


class Tape:
    """Stands in the place of `morse.viewer.server.ViewServer`: the feeds of the live view send their messages to it.

    Attributes:
        wishes: what is kept.
        time: seconds of the run, of what is sent.
    """

    watched = True

    def __init__(self, title: str) -> None:
        self.wishes = Wishes()
        self.time = 0.0
        self._title = title
        self._asset_store = AssetStore()
        self._key: str | None = None
        self._revision = 0
        self._files: dict[str, tuple[str, bytes]] = {}
        self._messages: list[tuple[float, str, JsonObject, bytes]] = []
        self._last: JsonObject = {}
        #: of each world: revision, times, poses
        self._poses: list[tuple[int, list[float], list[NDArray[np.int32]]]] = []

    # what feeds call --------------------------------------------------------------------------

    def send(self, message: ServerMessage) -> None:
        """Keep a message, unless the last one about its subject was equal."""
        subject = message.subject()
        assert subject is not None, "answers are sent to pages"
        about, payload = "/".join(subject), b""
        if isinstance(message, Payload):
            payload = message.payload if isinstance(message, Picture) else _rounded(message.payload)
            message = msgspec.structs.replace(message, payload=b"")
        plain = json.loads(encode_json(message), parse_float=_short)
        plain.pop("payload", None)
        if self._last.get(about) == (plain, payload):
            return
        self._last[about] = plain, payload
        self._messages.append((self.time, about, plain, payload))

    def offer(self, folder: str, mime: str, data: bytes) -> str:
        """Keep a file, and return its address."""
        url = f"/{folder}/{len(self._files)}"
        self._files[url] = mime, data
        return url

    def set_scene(self, scene: Scene, moving: Sequence[MovingNode]) -> None:
        """Describe the world."""
        self._revision += 1
        if self._key is None:
            self._key = world_key(scene)
        description = encode_json(describe(scene, moving, self._revision, self._asset_store, self._key))
        url = f"/worlds/{self._revision}.json"
        self._files.update(self._asset_store.take_new())
        self._files[url] = "application/json", description
        self.send(World(self._revision, url))

    def publish(self, poses: NDArray[np.float32]) -> None:
        """Keep the poses, (M, 7)."""
        if not self._poses or self._poses[-1][0] != self._revision:
            self._poses.append((self._revision, [], []))
        _, times, rows = self._poses[-1]
        times.append(round(self.time, 5))
        # what falls for ever leaves the range: its last place is shown
        rows.append(np.rint(np.clip(poses.ravel() / PLACES, -_FARTHEST, _FARTHEST)).astype(np.int32))

    # the file ---------------------------------------------------------------------------------

    def to_bytes(self, begin: float, end: float, frequency: float, limit: int) -> bytes:
        """The tape, compressed: a line of JSON, then the parts that it refers to.

        Args:
            begin, end: of the run, s.
            frequency: ticks per second.
            limit: bytes; images are left out until the tape is not longer.
        """
        pictures = [entry for entry in self._messages if entry[2]["type"] == Picture.__struct_config__.tag]
        others = [entry for entry in self._messages if entry[2]["type"] != Picture.__struct_config__.tag]
        facts = {"title": self._title, "begin": begin, "end": end, "frequency": frequency}
        data = self._packed(facts, others)
        left = max(limit - len(data), 0)
        size = sum(len(entry[3]) for entry in pictures)
        if pictures and size:
            # evenly over the run, the first one in any case
            step = max(1, -(-size // max(left, 1)))
            data = self._packed(facts, [*others, *_every(pictures, step)])
            while len(data) > limit and step < len(pictures):
                step += 1 + step // 4
                data = self._packed(facts, [*others, *_every(pictures, step)])
        return data

    def _packed(self, facts: JsonObject, messages: list[tuple[float, str, JsonObject, bytes]]) -> bytes:
        parts: list[bytes] = []
        size = 0

        def place(data: bytes) -> tuple[int, int]:
            nonlocal size
            begin, size = size, size + len(data)
            parts.append(data)
            return begin, len(data)

        poses = []
        for revision, times, rows in self._poses:
            steps = np.diff(np.array(rows), axis=0, prepend=np.zeros((1, len(rows[0])), np.int32)).astype("<i4")
            # bytes of the same weight stand together, because those of high weight are zeros
            begin, _ = place(steps.view(np.uint8).reshape(-1, 4).T.tobytes())
            poses.append({"revision": revision, "times": times, "width": len(rows[0]), "begin": begin})
        files = {url: [mime, *place(data)] for url, (mime, data) in self._files.items()}
        entries = [
            [round(time, 5), about, plain, list(place(payload)) if payload else None]
            for time, about, plain, payload in sorted(messages, key=lambda entry: entry[0])
        ]
        head = json.dumps(
            {**facts, "places": PLACES, "poses": poses, "files": files, "messages": entries}, separators=(",", ":")
        ).encode()
        return gzip.compress(len(head).to_bytes(4, "little") + head + b"".join(parts), compresslevel=9, mtime=0)


def _every(pictures: list[tuple[float, str, JsonObject, bytes]], step: int) -> list[Any]:
    """Every ``step``-th image of each camera."""
    counts: dict[str, int] = {}
    frames = []
    for entry in pictures:
        number = counts.get(entry[1], 0)
        counts[entry[1]] = number + 1
        if number % step == 0:
            frames.append(entry)
    return frames


def _rounded(floats: bytes) -> bytes:
    """Points with 12 instead of 23 bits of mantissa: a millimetre at ten metres, and half the size when compressed."""
    return ((np.frombuffer(floats, "<u4") + np.uint32(1 << 10)) & np.uint32(0xFFFFF800)).tobytes()


def _short(text: str) -> float:
    value = float(text)
    return float(f"{value:.{_DIGITS}g}") if abs(value) < 10 ** (_DIGITS - _DECIMALS) else round(value, _DECIMALS)
