"""A recorded run as one file: a page that needs no server."""

from __future__ import annotations

import base64
import gzip
import html
import json
import re
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np

from morse.core.declarations import data_fields
from morse.recording.fields.blocks import RecordedFields
from morse.simulation.recordings.timeline import RecordedTimeline
from morse.viewer.describe import appearances, describe, moving_nodes, world_key
from morse.viewer.feeds.components import ValuesFeed, component_tree
from morse.viewer.feeds.recorded import RecordedPicturesFeed, RecordedValuesFeed, cast_wished_rays
from morse.viewer.feeds.sensors import CONTACTS, ViewFrustums, ViewOverlays, ViewRays
from morse.viewer.hub import Wishes
from morse.viewer.protocol import VERSION, encode_json
from morse.viewer.site import STATIC, AssetStore
from morse.viewer.view_messages import History, Payload, Picture, Recordings, Seat, Tree, Welcome, World

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from morse.core.values import JsonObject
    from morse.recording.recording import Recording
    from morse.scene import Scene
    from morse.simulation.recordings.timeline import Timeline
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import Feed
    from morse.viewer.snapshot import MovingNode
    from morse.viewer.view_messages import ServerMessage


# The page of the live view with a recording in it, as one file.

#: the browser loads nothing from elsewhere
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src data: blob:; base-uri 'none'; form-action 'none'"
)
_SCRIPT = re.compile(r'<script type="module"[^<>]* src="\./([^"]+)"></script>')
_STYLE = re.compile(r'<link rel="stylesheet"[^<>]* href="\./([^"]+)">')
_ICON = re.compile(r'<link rel="icon"[^<>]* href="\./([^"]+)"[^<>]*>')


def page_of(recording: bytes, title: str, folder: Path = STATIC) -> str:
    """The text of a page that plays a recording.

    Args:
        recording: see `morse.viewer.exported_page.PageRecording.to_bytes`.
        title: of the page.
        folder: the files of the page.

    Raises:
        FileNotFoundError: MORSE was installed without the page.
    """
    index = folder / "index.html"
    if not index.is_file():
        raise FileNotFoundError(f"{index}: MORSE was built without the page of the live view")
    text = index.read_text(encoding="utf-8")

    def content(name: str) -> str:
        return (folder / name).read_text(encoding="utf-8")

    licences = content("assets/licences.txt").replace("--", "- -")
    icon = _ICON.search(text)
    image = base64.b64encode((folder / icon[1]).read_bytes()).decode() if icon else ""
    data = f'<script id="tape" type="application/octet-stream">{base64.b64encode(recording).decode()}</script>'
    text = text.replace("<title>MORSE</title>", f"<title>{html.escape(title)}</title>")
    text = _ICON.sub(f'<link rel="icon" type="image/svg+xml" href="data:image/svg+xml;base64,{image}">', text)
    text = _STYLE.sub(lambda match: f"<style>{content(match[1])}</style>", text)
    text = _SCRIPT.sub(lambda match: f'{data}<script type="module">{_inline(content(match[1]))}</script>', text)
    policy = f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}" />'
    return text.replace("<head>", f"<head>\n    <!-- made by MORSE; it contains:\n{licences}-->\n    {policy}", 1)


def _inline(script: str) -> str:
    """A script ends at the first ``</script``, also within a string."""
    return script.replace("</script", "<\\/script")


# The messages and poses of a run, kept for a page that plays them without a server.

#: poses are stored as multiples of this, m and without unit
PLACES = 1e-4
_FARTHEST = 2.0e9
#: digits and decimals of the numbers of a message: a millimetre in degrees of latitude, in coordinates of a map, and
#: ten microseconds in times since 1970; half of the digits of JSON
_DIGITS, _DECIMALS = 10, 5


class PageRecording:
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
        """The recording, compressed: a line of JSON, then the parts that it refers to.

        Args:
            begin, end: of the run, s.
            frequency: ticks per second.
            limit: bytes; images are left out until the recording is not longer.
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


def _every(
    pictures: list[tuple[float, str, JsonObject, bytes]], step: int
) -> list[tuple[float, str, JsonObject, bytes]]:
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


# Plays a recorded run once, and keeps what a page shows of it.

#: Hz of the poses, between which the page interpolates; of data; of rays and other overlays, and of images
_POSES, _DATA, _SIGHTS = 20.0, 10.0, 5.0
#: maximum number of cameras whose images are kept, if the script shows none
_CAMERAS = 3
#: maximum number of places of the time line
_PLACES = 1000
#: bytes of a recording: of the first minute, and of each further second
_FIRST, _FURTHER = 3_000_000, 45_000


class Span(NamedTuple):
    """The part of a run, in simulated seconds; a length of None is the rest."""

    begin: float = 0.0
    length: float | None = None


def page_recording_of(
    simulation: Simulation, timeline: Timeline, recording: Recording, title: str, span: Span
) -> bytes:
    """What a page plays of a recorded run, for `page_of`.

    Args:
        simulation: of the scene of the recording.
        timeline: the run.
        recording: the file of the run.
        title: of the page.
        span: the part that is kept.

    Raises:
        ValueError: the recording ends before the part begins.
    """
    context, world = simulation.context, simulation.world
    frequency, start = simulation.clock.frequency, simulation.clock.time
    recorded_timeline = timeline if isinstance(timeline, RecordedTimeline) else None
    first = round(span.begin * frequency)
    last = timeline.length if span.length is None else min(timeline.length, first + round(span.length * frequency))
    if first >= last:
        raise ValueError(f"the recording ends after {timeline.length / frequency:g} s, before the page begins")
    server: Any = PageRecording(title)
    server.wishes = _wishes(simulation)
    fields = RecordedFields(recording)
    values = (
        ValuesFeed(context, server)
        if recorded_timeline is None
        else RecordedValuesFeed(context, server, recorded_timeline, fields)
    )
    pictures = RecordedPicturesFeed(context, server, fields, lambda: server.time, looks=recorded_timeline is not None)
    overlays: list[Feed] = [
        ViewRays(context, server),
        ViewOverlays(context, server),
        ViewFrustums(context, server),
        pictures,
    ]

    server.time = begin = start + first / frequency
    end = start + last / frequency
    server.send(Welcome(VERSION, 1, title))
    server.send(Seat(1, [], 1))
    server.send(Recordings([], possible=False))
    places = min(last - first, _PLACES)
    server.send(History([begin + (end - begin) * place / places for place in range(places + 1)], recorded=True))

    layout, components = -1, list[str]()
    for number in range(int((last - first) / frequency * _POSES) + 1):
        position = min(first + round(number * frequency / _POSES), last)
        while not timeline.approach(position):
            pass
        server.time = start + position / frequency
        if world.layout != layout:
            layout = world.layout
            server.set_scene(simulation.scene, moving_nodes(world))
        if components != [*context.robots, *context.components]:
            components = [*context.robots, *context.components]
            server.wishes = _wishes(simulation)
            server.send(Tree(component_tree(context)))
            ViewOverlays(context, server).announce()
            for feed in overlays:
                getattr(feed, "restarted", list)()
        for look in appearances(world):
            server.send(look)
        server.publish(timeline.poses())
        if number % round(_POSES / _DATA) == 0:
            values.update()
        if number % round(_POSES / _SIGHTS) == 0:
            if recorded_timeline is not None:
                cast_wished_rays(context, server.wishes.overlays)
            for feed in overlays:
                feed.update()
    data: bytes = server.to_bytes(begin, end, frequency, _FIRST + int(max(end - begin - 60.0, 0.0) * _FURTHER))
    return data


def _wishes(simulation: Simulation) -> Wishes:
    """The data of all components, and the rays, overlays and images that the script shows, or else some cameras."""
    context = simulation.context
    display = simulation.scene.settings.view.display
    parts = context.components
    cameras = [name for name, part in parts.items() if "image" in data_fields(type(part))][:_CAMERAS]
    images = [name for name in display.images if name in parts] or cameras
    components = set(parts) if {"rays", "cones"} & set(display.overlays) else {*display.rays, *images}
    contacts = {CONTACTS} & set(display.overlays)
    return Wishes(values=frozenset(parts), overlays=frozenset(components | contacts), images=frozenset(images))
