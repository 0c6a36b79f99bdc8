"""A camera of a vehicle: the camera protocol of MAVLink."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from morse.core.declarations import kinds
from morse.core.kinds.turning import quaternion_of
from morse.mathutils.rotations import product
from morse.plugins.mavlink.telemetry import boot_ms
from morse.wire.images import image_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.object import Object
    from morse.mathutils.rotations import Quaternion4, Rotation9
    from morse.plugins.mavlink.autopilot.modes import Craft


#: bytes of all photos, of which the oldest are dropped; number of photos whose place is remembered
_MOST_BYTES, _MOST_PHOTOS = 1 << 26, 10_000


class Photo(NamedTuple):
    """One photo.

    Attributes:
        number: counts the photos of the camera from 0.
        path: of its file.
        stamp: simulated time, ns.
        place: latitude and longitude, 1e-7 degrees, altitude and height above home, mm.
        orientation: of the camera, w, x, y, z; forward, right, down to north, east, down.
    """

    number: int
    path: str
    stamp: int
    place: tuple[int, ...]
    orientation: Quaternion4

    @property
    def url(self) -> str:
        """Where MAVLink FTP has it."""
        return f"mftp:///{self.path}"


class Photos(Mapping[str, bytes]):
    """The files by path, and the list of what each camera has taken.

    Attributes:
        capacity: bytes.
        used: bytes.
    """

    capacity = _MOST_BYTES

    def __init__(self) -> None:
        self.used = 0
        self._files: dict[str, bytes] = {}
        self._lists: dict[int, list[Photo]] = {}

    def __getitem__(self, path: str) -> bytes:
        return self._files[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)

    def add(
        self, component: int, content: bytes, stamp: int, place: tuple[int, ...], orientation: Quaternion4
    ) -> Photo:
        """Store a photo of the camera with an id; see `Photo`."""
        photos = self._lists.setdefault(component, [])
        number = photos[-1].number + 1 if photos else 0
        photo = Photo(number, f"DCIM/{component}/{number:06d}.jpg", stamp, place, orientation)
        photos.append(photo)
        del photos[:-_MOST_PHOTOS]
        self._files[photo.path] = content
        self.used += len(content)
        while self.used > _MOST_BYTES:
            self.used -= len(self._files.pop(next(iter(self._files))))
        return photo

    def photo(self, component: int, number: float) -> Photo | None:
        """A photo of a camera; None if it is not remembered."""
        photos = self._lists.get(component)
        if not photos or not photos[0].number <= number <= photos[-1].number:
            return None
        return photos[int(number) - photos[0].number]

    def count(self, component: int) -> int:
        """How many photos a camera has taken."""
        photos = self._lists.get(component)
        return photos[-1].number + 1 if photos else 0

    def has(self, photo: Photo) -> bool:
        """Whether the file of a photo is still there."""
        return photo.path in self._files

    def clear(self) -> None:
        """Delete all photos."""
        self._files.clear()
        self._lists.clear()
        self.used = 0


#: MAV_RESULT
_ACCEPTED, _TRY_AGAIN, _DENIED, _UNSUPPORTED = 0, 1, 2, 3
_INFORMATION, _SETTINGS, _STORAGE, _STATUS, _CAPTURED, _HEARTBEAT = 259, 260, 261, 262, 263, 0
#: MAV_TYPE_CAMERA, MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE; CAMERA_CAP_FLAGS_CAPTURE_IMAGE
_CAMERA, _NO_AUTOPILOT, _ACTIVE, _TAKES_IMAGES = 30, 8, 4, 2
#: STORAGE_STATUS_READY, STORAGE_TYPE_OTHER, and what it is for: photos by default
_READY, _OTHER, _FOR_PHOTOS = 2, 254, 1 | 2
_MEBI = 1 << 20
_SECOND = 10**9
#: of JPEG; s: shortest time between two photos
_QUALITY, _SHORTEST = 90, 0.1
_MODE_IMAGE = 0
#: forward, left and up in the axes of a camera, which looks along Z and has Y downward
_AHEAD: Rotation9 = (0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0)


class Camera:
    """Takes the newest image of a camera of the robot as a photo.

    Args:
        component: the id in messages.
        sensor: the camera of MORSE.
        flight: the state of the vehicle.
        photos: where the photos of all cameras of the vehicle are kept.
    """

    def __init__(self, component: int, sensor: Object, flight: Craft, photos: Photos) -> None:
        self.component, self._sensor, self._flight, self._photos = component, sensor, flight, photos
        self._stamp = 0
        #: number of photos to be taken, infinite without a limit; their interval, ns; the time of the next one, ns
        self._left, self._interval, self._due = 0.0, 0, 0
        #: time of the next photo at the earliest, ns; number of the last command for a single photo, 0 for none
        self._earliest, self._number = 0, 0.0
        #: m between photos, 0 for none, and where the last one was taken
        self._spacing, self._last_place = 0.0, (0.0, 0.0, 0.0)

    def _send(self, name: str, *values: object) -> None:
        self._flight.vehicle.send_from(self.component, name, *values)

    # -- commands ----------------------------------------------------------------------------

    def obey(self, command: int, params: tuple[float, ...]) -> int:
        """Execute a command; MAV_RESULT."""
        execute = self._COMMANDS.get(command)
        return _UNSUPPORTED if execute is None else execute(self, params)

    def _request(self, params: tuple[float, ...]) -> int:
        return self._answer(params[0], params[1])

    def _answer(self, number: float, index: float = 0.0) -> int:
        send = self._MESSAGES.get(number)
        if number == _CAPTURED:
            photo = self._photos.photo(self.component, index)
            if photo is None:
                return _DENIED
            self._tell(photo)
            return _ACCEPTED
        if send is None:
            return _UNSUPPORTED
        send(self)
        return _ACCEPTED

    def _start(self, params: tuple[float, ...]) -> int:
        interval, count, number = params[1:4]
        if not (0.0 <= interval < 1e6 and 0.0 <= count < 1e9):
            return _DENIED
        number = number if count == 1.0 and number > 0.0 else 0.0
        if number and number == self._number:
            return _ACCEPTED  # it is sent again, because its answer was lost
        # there is one sequence at a time, which continues
        if self._left > 0.0 or not self._has_image():
            return _TRY_AGAIN
        self._left, self._due, self._number = count or math.inf, max(self._stamp, self._earliest), number
        self._interval = round(max(interval, _SHORTEST) * _SECOND)
        self._shoot()
        return _ACCEPTED

    def _stop(self, params: tuple[float, ...]) -> int:
        self._left, self._spacing = 0.0, 0.0
        return _ACCEPTED

    def _by_distance(self, params: tuple[float, ...]) -> int:
        spacing = params[0]
        if not 0.0 <= spacing < 1e6:
            return _DENIED
        self._spacing = spacing
        # the third parameter: take one at once
        self._last_place = self._flight.now.position
        if spacing and params[2] == 1.0:
            self._left = max(self._left, 1.0)
        return _ACCEPTED

    def _set_mode(self, params: tuple[float, ...]) -> int:
        return _ACCEPTED if params[1] == _MODE_IMAGE else _DENIED

    def _digicam(self, params: tuple[float, ...]) -> int:
        return self._start((0.0, 0.0, 1.0, 0.0)) if params[4] == 1.0 else _ACCEPTED

    def _format(self, params: tuple[float, ...]) -> int:
        if params[1] == 1.0:
            self._photos.clear()
        return _ACCEPTED

    # -- photos ------------------------------------------------------------------------------

    def _has_image(self) -> bool:
        return bool(np.size(self._sensor.local_data["image"]))

    def _shoot(self) -> None:
        """Take a photo, if one is due."""
        if self._spacing and math.dist(self._last_place, self._flight.now.position) >= self._spacing:
            self._last_place = self._flight.now.position
            self._left = max(self._left, 1.0)
        if self._left <= 0.0 or self._stamp < self._due or not self._has_image():
            return
        self._left -= 1.0
        self._earliest = self._stamp + round(_SHORTEST * _SECOND)
        self._due = max(self._stamp + self._interval, self._earliest)
        flight = self._flight
        body: Any = self._sensor.bge_object
        position, rotation = body.world_pose()
        latitude, longitude, altitude = flight.place.earth(position)
        q = quaternion_of(*flight.place.axes.angles_of(product(rotation, _AHEAD)))
        content = image_file(self._sensor.local_data["image"], "jpeg", _QUALITY)
        where = (round(latitude * 1e7), round(longitude * 1e7), *(
            max(-(1 << 31), min(round(1000.0 * v), (1 << 31) - 1)) for v in (altitude, position[2] - flight.home[2])
        ))  # fmt: skip
        self._tell(self._photos.add(self.component, content, self._stamp, where, q))

    def _tell(self, photo: Photo) -> None:
        result = 1 if self._photos.has(photo) else 0
        self._send(
            "camera_image_captured", boot_ms(photo.stamp), 0, 0, *photo.place, list(photo.orientation), photo.number,
            result, photo.url.encode(),
        )  # fmt: skip

    # -- messages ----------------------------------------------------------------------------

    def tick(self, stamp: int) -> None:
        """Take the photos that are due at a simulated time, ns."""
        if stamp < self._stamp:  # the simulation has started again
            self._left, self._spacing = 0.0, 0.0
            self._due, self._earliest, self._number = 0, 0, 0.0
        self._stamp = stamp
        self._shoot()

    def beat(self) -> None:
        """Send a heartbeat."""
        self._send("heartbeat", _CAMERA, _NO_AUTOPILOT, 0, 0, _ACTIVE)

    def _inform(self) -> None:
        camera: Any = self._sensor
        width, height = camera.image_width, camera.image_height
        # the focal length of MORSE is for a sensor that is 32 mm wide
        wide = 32.0
        focal = float(np.asarray(camera.local_data["intrinsic_matrix"])[0][0]) * wide / width
        vendor, model = (list(text.encode()[:32].ljust(32, b"\0")) for text in ("MORSE", camera.name()))
        self._send(
            "camera_information", boot_ms(self._stamp), vendor, model, 0, focal, wide, wide * height / width, width,
            height, 0, _TAKES_IMAGES, 0, b"",
        )  # fmt: skip

    def _settings(self) -> None:
        self._send("camera_settings", boot_ms(self._stamp), _MODE_IMAGE, math.nan, math.nan)

    def _storage(self) -> None:
        total, full = self._photos.capacity / _MEBI, self._photos.used / _MEBI
        self._send(
            "storage_information", boot_ms(self._stamp), 1, 1, _READY, total, full, total - full, math.nan, math.nan,
            _OTHER, b"memory", _FOR_PHOTOS,
        )  # fmt: skip

    def _status(self) -> None:
        # idle, in progress, or at intervals
        state = 0 if not self._left else 3 if self._left > 1.0 else 1
        free = (self._photos.capacity - self._photos.used) / _MEBI
        count = self._photos.count(self.component)
        self._send("camera_capture_status", boot_ms(self._stamp), state, 0, self._interval / _SECOND, 0, free, count)

    _MESSAGES: ClassVar[dict[float, Callable[[Camera], None]]] = {
        _HEARTBEAT: beat, _INFORMATION: _inform, _SETTINGS: _settings, _STORAGE: _storage, _STATUS: _status,
    }  # fmt: skip

    _COMMANDS: ClassVar[dict[int, Callable[[Camera, tuple[float, ...]], int]]] = {
        203: _digicam, 206: _by_distance, 512: _request, 526: _format, 530: _set_mode, 2000: _start, 2001: _stop,
        # those from before MAV_CMD_REQUEST_MESSAGE
        521: lambda camera, _: camera._answer(_INFORMATION), 522: lambda camera, _: camera._answer(_SETTINGS),
        525: lambda camera, _: camera._answer(_STORAGE), 527: lambda camera, _: camera._answer(_STATUS),
    }  # fmt: skip


#: MAV_COMP_ID_CAMERA and the five that follow
_FIRST, _MOST = 100, 6
#: commands for cameras that arrive at the autopilot go to the first camera, as with PX4
_FORWARDED = (203, 206, 521, 522, 525, 526, 527, 530, 2000, 2001)


class Cameras:
    """The cameras, and their photos."""

    def __init__(self, flight: Craft) -> None:
        self._flight = flight
        self.photos = Photos()
        self._cameras: dict[int, Camera] = {}
        self._sensors: list[Object] = []

    def look_at(self, components: Iterable[Object]) -> None:
        """Find the cameras among the components of the robot."""
        sensors = [one for one in components if _has_photos(one)][:_MOST]
        if sensors != self._sensors:
            self._sensors = sensors
            self._cameras = {
                number: Camera(number, sensor, self._flight, self.photos)
                for number, sensor in enumerate(sensors, _FIRST)
            }

    def is_for(self, component: int, command: int) -> bool:
        """Whether a command for a component is one for a camera."""
        return component in self._cameras or (command in _FORWARDED and bool(self._cameras))

    def obey(self, component: int, command: int, params: tuple[float, ...]) -> int:
        """Execute a command; MAV_RESULT."""
        camera = self._cameras.get(component) or next(iter(self._cameras.values()))
        return camera.obey(command, params)

    def beat(self) -> None:
        """Send the heartbeats of all cameras."""
        for camera in self._cameras.values():
            camera.beat()

    def tick(self, stamp: int) -> None:
        """The end of a tick, at a simulated time, ns."""
        for camera in self._cameras.values():
            camera.tick(stamp)


def _has_photos(component: object) -> bool:
    """Whether a component has colour images."""
    uses = kinds(type(component))
    return any(use.kind == "image" and use.slots.get("encoding") == "rgba8" for use in uses)
