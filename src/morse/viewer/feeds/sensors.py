"""What pages show of sensors in the world: images, rays, point clouds, fields of view, overlays; and sounds."""

from __future__ import annotations

import io
import logging
import math
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from morse.actuators.sound import Sound
from morse.core.declarations import fields_of_component
from morse.core.image_colors import as_pixels, depth_levels, is_picture, is_temperature, unit_of
from morse.core.reports.quoting import shown
from morse.core.sensor import Sensor
from morse.physics.rays import RayBundle
from morse.system.regular_files import read_regular
from morse.viewer.view_messages import Cloud, Cone, Contacts, Frustum, MassCentre, Picture, Rays, Sighting, SoundState

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.sensor import WatchedSpace
    from morse.core.values import Fields, JsonObject
    from morse.rendering.lens import Lens
    from morse.viewer.server import ViewServer


# Sends camera images to pages.

_QUALITY = 85
#: maximum number of objects with boxes that are sent with an image
_MOST_SIGHTINGS = 200
_LONGEST_NAME = 80


class Shot(NamedTuple):
    """An image of a camera.

    Attributes:
        image: the top row is first.
        source: changes with every new image.
        time: simulated seconds.
        objects: the objects that the camera has detected.
    """

    image: np.ndarray
    source: object
    time: float
    objects: Any = ()


class PicturesFeed:
    """Sends the images of the cameras whose panels are open."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_pictures: Fields = {}

    def update(self) -> None:
        """Send the images captured since the last call."""
        wishes = self._server.wishes.images
        for name in self._last_pictures.keys() - wishes:
            del self._last_pictures[name]
            self._watch(name, False)
        for name in sorted(wishes):
            component = self._context.components.get(name)
            self._watch(name, True)
            shot = None if component is None else self.shot(name, component)
            if shot is None or shot.source is self._last_pictures.get(name):
                continue
            self._last_pictures[name] = shot.source
            self._server.send(picture_of(name, component, shot))

    def _watch(self, name: str, on: bool) -> None:
        """A camera without an image in its data renders one only while a page shows it."""
        component: Any = self._context.components.get(name)
        if hasattr(component, "shown"):
            component.watched = on
            self._last_pictures.setdefault(name, None)

    def shot(self, _name: str, component: Any) -> Shot | None:
        """The last image of a camera."""
        show = getattr(component, "shown", None)
        return shot_of(component, component.local_data if show is None else show())


def shot_of(component: object, data: Mapping[str, object]) -> Shot | None:
    """The image in the data of a camera; None if there is none."""
    image = data.get("image")
    if not is_picture(image):
        return None
    top_first = image if getattr(component, "vertical_flip", True) else image[::-1]
    time = data.get("timestamp", 0.0)
    return Shot(top_first, image, time if isinstance(time, float) else 0.0, data.get("objects", ()))


def picture_of(name: str, component: object, shot: Shot) -> Picture:
    """The message for an image of a camera."""
    image = shot.image
    height, width = image.shape[:2]
    if image.dtype == np.uint16 and image.ndim == 2:
        rows = zlib.compress(np.ascontiguousarray(image, "<u2").data, 1)
        objects = list(sightings(shot.objects))
        return Picture(rows, name, width, height, "image/x-u16", shot.time, "ids", sightings=objects)
    if image.ndim == 2 and image.dtype != np.uint8:
        levels = depth_levels(image)
        unit = unit_of(component)
        jpeg = as_jpeg(levels.grey)
        meaning: Literal["depth", "temperature"] = "temperature" if is_temperature(component) else "depth"
        return Picture(jpeg, name, width, height, "image/jpeg", shot.time, meaning, levels.low, levels.high, unit)
    boxes = list(sightings(shot.objects))
    return Picture(as_jpeg(as_pixels(image)), name, width, height, "image/jpeg", shot.time, sightings=boxes)


def sightings(objects: object) -> Iterator[Sighting]:
    """The objects of a camera that have a box; invalid entries are left out."""
    for thing in list(objects)[:_MOST_SIGHTINGS] if isinstance(objects, (list, tuple)) else ():
        if not isinstance(thing, dict):
            continue
        try:
            x0, y0, x1, y1 = (float(edge) for edge in thing["box"])
            number = int(thing.get("id", 0))
        except (TypeError, ValueError, KeyError, OverflowError):
            continue
        if all(map(math.isfinite, (x0, y0, x1, y1))):
            label, kind = (str(thing.get(key, ""))[:_LONGEST_NAME] for key in ("name", "class"))
            yield Sighting(number, label, kind, (x0, y0, x1, y1))


def as_jpeg(pixels: NDArray[np.uint8]) -> bytes:
    """Encode an image as a file."""
    # imported with the first image
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "JPEG", quality=_QUALITY)
    return data.getvalue()


# Sends the rays of sensors to pages.

#: maximum number of rays; above it, every second, third, ... ray is sent: a ray is 28 bytes, ten times per second
_MOST_RAYS = 4000


class ViewRays:
    """Sends the rays of sensors that pages show, and of those with a visible arc."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_counts: dict[str, int] = {}
        self._components: list[Object] = []
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._components = [c for c in self._context.components.values() if _bundles(c)]

    def update(self) -> None:
        """Send the rays cast since the last call."""
        wishes = self._server.wishes.overlays
        for component in self._components:
            name = component.name()
            is_shown = name in wishes or bool(getattr(component, "visible_arc", False))
            if isinstance(component, Sensor):
                component.watched = is_shown
            if not is_shown:
                self._last_counts.pop(name, None)
                continue
            bundles = [bundle for bundle in _bundles(component) if bundle.stamp >= 0]
            stamp = max((bundle.stamp for bundle in bundles), default=None)
            if stamp is not None and self._last_counts.get(name) != stamp:
                self._last_counts[name] = stamp
                segments = np.concatenate([bundle.segments() for bundle in bundles])
                step = -(-len(segments) // _MOST_RAYS)
                self._server.send(Rays(segments[:: max(step, 1)].tobytes(), name))


def _bundles(component: Object) -> list[RayBundle]:
    return [request for request in component.requests if isinstance(request, RayBundle)]


# Sends the point clouds of depth cameras to pages.

#: maximum number of points; above it, every second, third, ... point is sent: a point is 12 bytes
_MOST_POINTS = 10_000


class ViewClouds:
    """Sends the clouds of the sensors that pages show; those of sensors with rays are shown as rays."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_clouds: Fields = {}
        self._components: list[Object] = []
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._components = [c for c in self._context.components.values() if c.rays is None and has_points(c)]

    def update(self) -> None:
        """Send the clouds measured since the last call."""
        wishes = self._server.wishes.overlays
        for component in self._components:
            name = component.name()
            if name not in wishes:
                self._last_clouds.pop(name, None)
                continue
            points = component.local_data.get("points")
            if points is self._last_clouds.get(name):
                continue
            self._last_clouds[name] = points
            self._server.send(Cloud(in_world(component, points).tobytes(), name))


def has_points(component: Object) -> bool:
    """Whether a component measures a cloud: a field ``points`` of shape (N, 3)."""
    field = fields_of_component(component).get("points")
    return field is not None and tuple(field.shape or ()) == (None, 3)


def in_world(component: Any, points: object) -> NDArray[np.float32]:
    """Some points of a cloud, (N, 3), in the frame of the world; the origin of the sensor stands for no point."""
    array = np.asarray(points, np.float32)
    if array.ndim != 2 or array.shape[1] != 3:
        return np.zeros((0, 3), np.float32)
    array = array[np.isfinite(array).all(axis=1) & array.any(axis=1)]
    array = array[:: max(-(-len(array) // _MOST_POINTS), 1)]
    position, rotation = component.measured_from()
    return np.asarray(array @ np.reshape(rotation, (3, 3)).T + np.array(position), np.float32)


# Sends the fields of view of cameras to pages.

#: number of directions for each side of an image: a fisheye lens bends the sides
SIDE = 8
#: number of steps from the border of an image to its centre, to find the first valid pixel
_STEPS = 64


class ViewFrustums:
    """Sends the fields of view of the cameras whose overlays are shown, after every change of a lens."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_frustums: JsonObject = {}

    def restarted(self) -> None:
        """Send everything again, because the components are described again."""
        self._last_frustums.clear()

    def update(self) -> None:
        """Send the changes since the last call."""
        for name in sorted(self._server.wishes.overlays):
            component = self._context.components.get(name)
            lens = getattr(component, "lens", None)
            if lens is not None and self._last_frustums.get(name) is not lens:
                self._last_frustums[name] = lens
                self._server.send(Frustum(name, [(x, y, z) for x, y, z in rim(lens).tolist()], lens.near, lens.far))


def rim(lens: Lens) -> NDArray[np.float64]:
    """The directions of the border of an image, (4 * SIDE, 3), clockwise from the upper left corner.

    Where pixels of the border are not valid, as in the corners of some fisheye images, the nearest valid pixel on the
    way to the centre is used.
    """
    share = np.arange(SIDE) / SIDE
    one, none = np.ones(SIDE), np.zeros(SIDE)
    across = np.concatenate([share, one, 1.0 - share, none])
    down = np.concatenate([none, share, one, 1.0 - share])
    table = getattr(lens, "directions", None)
    if table is None:
        image_points = np.stack(
            [(across * lens.width - lens.cx) / lens.fx, (down * lens.height - lens.cy) / lens.fy], axis=1
        )
        image_points = np.column_stack([image_points, np.ones(len(image_points))])
        return np.asarray(image_points / np.linalg.norm(image_points, axis=1, keepdims=True), float)
    directions, shows = table
    inward = np.linspace(0.0, 1.0, _STEPS)[:, None]
    columns = np.clip((across + (0.5 - across) * inward) * lens.width, 0, lens.width - 1).astype(int)
    rows = np.clip((down + (0.5 - down) * inward) * lens.height, 0, lens.height - 1).astype(int)
    first = shows[rows, columns].argmax(axis=0)
    every = np.arange(len(across))
    return np.asarray(directions[rows[first, every], columns[first, every]], float)


# Sends overlays to pages: contacts, centres of mass, fields of view of sensors.

#: the name by which a page requests contacts
CONTACTS = "contacts"


class ViewOverlays:
    """Sends overlays to the pages that have requested them."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._had_contacts = False
        self._spaces: dict[str, WatchedSpace] = {}

    def announce(self) -> None:
        """Send the overlays that do not change: the centres of mass."""
        for name, mass, centre in self._context.world.mass_centres():
            self._server.send(MassCentre(name, mass, centre))

    def update(self) -> None:
        """Send the changes since the last call."""
        wishes = self._server.wishes.overlays
        if CONTACTS in wishes or self._had_contacts:
            self._had_contacts = CONTACTS in wishes
            points = self._context.world.contact_forces() if self._had_contacts else b""
            self._server.send(Contacts(points))
        for name in sorted(wishes):
            component = self._context.components.get(name)
            space = component.watched_space() if isinstance(component, Sensor) else None
            if space is not None and self._spaces.get(name) != space:
                self._spaces[name] = space
                self._server.send(Cone(name, space.reach, space.angle, list(space.seen)))


# Sends pages the sounds of loudspeakers of robots.

logger = logging.getLogger("morse.viewer")

#: maximum size of a sound file, bytes; a larger file is not sent
LARGEST = 32 << 20
#: signatures of sound files: offset, bytes, content type
_BEGINNINGS = (
    (8, b"WAVE", "audio/wav"),
    (0, b"OggS", "audio/ogg"),
    (0, b"fLaC", "audio/flac"),
    (0, b"ID3", "audio/mpeg"),
    (0, b"\xff\xfb", "audio/mpeg"),
    (0, b"\xff\xf3", "audio/mpeg"),
    (4, b"ftyp", "audio/mp4"),
    (0, b"\x1aE\xdf\xa3", "audio/webm"),
)


class SoundsFeed:
    """Sends the sounds of the actuators `morse.actuators.sound.Sound`.

    Only files that the scene script names are read: clients may set the property ``file`` to any path of this machine,
    and the page must not make it readable.
    """

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_states: dict[str, tuple[str, str]] = {}
        self._addresses: dict[str, str | None] = {}
        self._speakers: list[Sound] = []
        self._file_names: frozenset[str] = frozenset()
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._speakers = [one for one in self._context.components.values() if isinstance(one, Sound)]
        if self._speakers:
            self._file_names |= frozenset(named_files(self._context))

    def update(self) -> None:
        """Send the changes since the last call."""
        for speaker in self._speakers:
            name, state = speaker.name(), (speaker.mode, speaker.file)
            if self._last_states.get(name) != state:
                self._last_states[name] = state
                self._server.send(
                    SoundState(name, speaker.mode, self._address(name, speaker.file), speaker.played, self._now())
                )

    def _now(self) -> float:
        return self._context.clock.time

    def _address(self, name: str, file: str) -> str | None:
        if not file:
            return None
        if file not in self._file_names:
            # clients may set any number of long names: none of them is kept
            text = f"{name}: the scene script does not name {shown(file)}: pages play a tone"
            self._context.complaints.warn(f"{name}: sound", text)
            return None
        if file not in self._addresses:
            self._addresses[file] = self._offered(name, file)
        return self._addresses[file]

    def _offered(self, name: str, file: str) -> str | None:
        try:
            kind, data = read_sound(Path(file))
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            logger.warning("%s: %s is not sent to pages, which play a tone: %s", name, shown(file), reason)
            return None
        return self._server.offer("sounds", kind, data)


def named_files(context: Context) -> Iterable[str]:
    """The files of the actuators in the scene script."""
    for component in context.scene.components:
        file = component.node.properties.get("file")
        if isinstance(file, str):
            yield file


def read_sound(path: Path) -> tuple[str, bytes]:
    """The content type and the bytes of a sound file.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is too large, or of another format.
    """
    if not path.is_file():
        raise ValueError("there is no such file")
    data = read_regular(path, LARGEST)
    for offset, beginning, kind in _BEGINNINGS:
        if data[offset : offset + len(beginning)] == beginning:
            return kind, data
    raise ValueError("the file is not WAV, Ogg, FLAC, MP3, MP4 or WebM")
