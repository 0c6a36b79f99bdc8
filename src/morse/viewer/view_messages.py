"""Messages from the simulator to the pages."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from msgspec import Struct

from morse.viewer.description import (
    ComponentDescription,  # noqa: TC001 (msgspec reads it)
    LightDescription,  # noqa: TC001 (msgspec reads it)
    SettingDescription,  # noqa: TC001 (msgspec reads it)
)
from morse.viewer.page_messages import snake_case

Subject = tuple[str, ...]


class ServerMessage(Struct, frozen=True, tag_field="type", tag=snake_case):
    """A JSON object with a ``type``.

    Of two messages with the same subject, only the newer one is relevant: a slow page gets only that one.
    """

    _about: ClassVar[tuple[str, ...] | None] = ()
    """The fields that distinguish the subjects of such messages; None: every message is relevant."""

    _lasting: ClassVar[bool] = True

    def subject(self) -> Subject | None:
        """The subject of the message, or None if every message is relevant."""
        return None if self._about is None else (type(self).__name__, *(getattr(self, name) for name in self._about))

    @property
    def lasting(self) -> bool:
        """Also sent to pages that connect later."""
        return self._lasting


class Payload(ServerMessage, frozen=True):
    """A message with numbers or an image at its end: sent as a binary frame."""

    payload: bytes


# the connection ------------------------------------------------------------------------------------------


class Welcome(ServerMessage, frozen=True):
    """Answers the page's `Hello`; ``page`` is its id for other pages."""

    version: int
    page: int
    title: str


class World(ServerMessage, frozen=True):
    """There is a new world: fetch its description."""

    revision: int
    url: str


class Seat(ServerMessage, frozen=True):
    """The page that drives, the pages that have requested control, and the number of pages."""

    driver: int | None
    asking: list[int]
    pages: int


class Refused(ServerMessage, frozen=True):
    """A request of the page was refused."""

    what: str
    why: str

    _about: ClassVar[tuple[str, ...] | None] = None
    _lasting: ClassVar[bool] = False


# time and log ------------------------------------------------------------------------------------------------


class Pace(ServerMessage, frozen=True):
    """Whether the simulation keeps up with the wall clock.

    Attributes:
        strategy: e.g. ``Best Effort``.
        late: wall-clock seconds behind; 0 if it keeps up.
        cause: the cause of the delay, as a clause; empty if there is no particular cause.
    """

    strategy: str
    late: float = 0.0
    cause: str = ""


class TaskPoint(Struct, frozen=True):
    """A point of a task: what is expected, whether it is so, and if not, what might help."""

    what: str
    is_right: bool
    hint: str = ""


class Task(ServerMessage, frozen=True):
    """What a person in front of the page is to do.

    Attributes:
        text: Markdown of paragraphs, lists and code.
        points: what has been checked so far.
        is_checked: whether the check has ended.
    """

    title: str
    text: str
    points: list[TaskPoint]
    is_checked: bool = False


class RecordingDescription(Struct, frozen=True):
    """An active recording.

    Attributes:
        path: absolute.
        seconds: simulated seconds in it.
        bytes: size of the file, without data that wait to be written.
        stoppable: whether the service ``stop_recording`` ends it.
    """

    path: str
    seconds: float
    bytes: int
    stoppable: bool


class Recordings(ServerMessage, frozen=True):
    """The active recordings; none for a simulation that cannot be recorded."""

    recordings: list[RecordingDescription]
    possible: bool = True


class History(ServerMessage, frozen=True):
    """The simulated times (s) of the saved states, oldest first.

    Attributes:
        times: for a recorded run, times of the whole run, also ahead of the present one.
        recorded: whether this is a recorded run, which can also be played backward.
    """

    times: list[float]
    recorded: bool = False


class Log(ServerMessage, frozen=True):
    """A line of the log.

    Attributes:
        component: the component that the line is about, or empty.
        time: simulated seconds.
        place: index of the line modulo the number of lines that are kept for pages that connect later.
        shown: whether the page shows the same elsewhere, so that the line does not pop up.
    """

    level: Literal["debug", "info", "warning", "error"]
    text: str
    component: str = ""
    time: float = 0.0
    place: int = 0
    shown: bool = False

    _about: ClassVar[tuple[str, ...] | None] = ("place",)


class FileMistake(Struct, frozen=True):
    """An error in a file that was saved; ``line`` is 0 if it is not known."""

    file: str
    line: int
    text: str


class SavedFiles(ServerMessage, frozen=True):
    """The saved files with errors, and the names of those that are read at the next restart."""

    mistakes: list[FileMistake]
    waiting: list[str]


class AirPart(Struct, frozen=True):
    """How the air of a part of the world looks; see `morse.helpers.air.Look`."""

    color: tuple[float, float, float]
    extinction: float
    overhead: float
    rain: float
    snow: float
    corners: list[tuple[float, float]]
    top: float | None


class AirLook(ServerMessage, frozen=True):
    """How the air looks, the mean wind in m/s, and the share of the ground with water and with snow.

    The first part is the whole world but for the others; there is none if the air is clear.
    """

    parts: list[AirPart]
    wind: tuple[float, float, float]
    wet: float
    snow_cover: float


class DebugProperty(Struct, frozen=True):
    """A property of an object, with its value as text."""

    node: str
    name: str
    value: str


class DebugProperties(ServerMessage, frozen=True):
    """The properties that the script displays; ``more`` is the number of omitted ones."""

    properties: list[DebugProperty]
    more: int = 0


# components ----------------------------------------------------------------------------------------------


class Tree(ServerMessage, frozen=True):
    """All components, and services that belong to no component (``simulation``, ``time``)."""

    components: list[ComponentDescription]


class Listening(ServerMessage, frozen=True):
    """The robots that keys can drive, and the selected one (None: all of them)."""

    robots: list[str]
    robot: str | None = None


class Values(ServerMessage, frozen=True):
    """Data of a component at a simulated time (s); ``note`` says why they are incomplete, or what they are."""

    component: str
    time: float
    data: dict[str, Any]
    note: str = ""

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class PropertyValue(ServerMessage, frozen=True):
    """A property changed."""

    component: str
    name: str
    value: Any

    _about: ClassVar[tuple[str, ...] | None] = ("component", "name")


class Activity(ServerMessage, frozen=True):
    """A component was activated or deactivated."""

    component: str
    active: bool

    _about: ClassVar[tuple[str, ...] | None] = ("component",)


class Answer(ServerMessage, frozen=True):
    """The result of a request of the driving page."""

    request: int
    ok: bool
    value: Any = None
    error: str = ""

    _about: ClassVar[tuple[str, ...] | None] = None
    _lasting: ClassVar[bool] = False


# the world -----------------------------------------------------------------------------------------------


class Viewpoint(ServerMessage, frozen=True):
    """A service has moved the camera of scripts.

    Attributes:
        location: world frame, metres.
        rotation: Euler angles XYZ of a camera that looks along its -Z, radians.
        clip: near and far clipping distance, metres.
    """

    location: tuple[float, float, float]
    rotation: tuple[float, float, float]
    clip: tuple[float, float]


class Appearance(ServerMessage, frozen=True):
    """A node is hidden, shown or recoloured (linear RGBA, None: as its materials are), or its lamp has changed."""

    node: str
    visible: bool
    color: tuple[float, float, float, float] | None = None
    light: LightDescription | None = None

    _about: ClassVar[tuple[str, ...] | None] = ("node",)


class Rays(Payload, frozen=True):
    """The rays of a sensor: (N, 7) float32 of origin, end (m, world frame) and 1 for a hit."""

    component: str

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class Cloud(Payload, frozen=True):
    """The points of a cloud that a sensor has measured: (N, 3) float32, m, world frame."""

    component: str

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class Contacts(Payload, frozen=True):
    """Contacts: (N, 6) float32 of point (m) and force (N), both in the world frame."""

    _lasting: ClassVar[bool] = False


class Cone(ServerMessage, frozen=True):
    """The field of view of a sensor, around the X axis of its node.

    Attributes:
        reach: metres.
        angle: full opening angle, radians; 2 pi for a sphere.
        seen: names of the objects that it detects now.
    """

    component: str
    reach: float
    angle: float
    seen: list[str] = []

    _about: ClassVar[tuple[str, ...] | None] = ("component",)


class Frustum(ServerMessage, frozen=True):
    """The field of view of a camera.

    Attributes:
        rim: directions of the border of the image as unit vectors in the frame of the camera (X right, Y down,
            Z forward), clockwise from the upper left corner, the same number for each side.
        near, far: clipping distances along the axis, metres.
    """

    component: str
    rim: list[tuple[float, float, float]]
    near: float
    far: float

    _about: ClassVar[tuple[str, ...] | None] = ("component",)


class MassCentre(ServerMessage, frozen=True):
    """Mass (kg) of a body and its centre in the frame of its node (m)."""

    node: str
    mass: float
    position: tuple[float, float, float]

    _about: ClassVar[tuple[str, ...] | None] = ("node",)


class Sighting(Struct, frozen=True):
    """An object that a camera has detected.

    Attributes:
        id: id of its pixels.
        kind: its class; empty if it has none.
        box: x0, y0, x1, y1, px from the upper left corner; x1 and y1 are one past the last pixel.
    """

    id: int
    name: str
    kind: str
    box: tuple[float, float, float, float]


class Picture(Payload, frozen=True):
    """The image of a camera.

    Attributes:
        mime: ``image/jpeg``, ``image/png``, ``image/x-rgba`` for raw rows of 8-bit RGBA, or ``image/x-u16`` for
            raw rows of little-endian uint16, compressed by zlib; the top row is first.
        meaning: of the pixels. Depth is 8-bit: 255 means ``low``, `FARTHEST_LEVEL` means ``high``, and pixels
            without depth are black; temperatures are the same. Ids are 16-bit, 0 for none.
        low, high: the smallest and the largest depth or temperature in the image, in ``unit``.
        sightings: the detected objects.
    """

    camera: str
    width: int
    height: int
    mime: str
    time: float = 0.0
    meaning: Literal["color", "depth", "ids", "temperature"] = "color"
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    sightings: list[Sighting] = []

    _about: ClassVar[tuple[str, ...] | None] = ("camera",)
    _lasting: ClassVar[bool] = False


class SoundState(ServerMessage, frozen=True):
    """The state of a loudspeaker.

    Attributes:
        component: also the name of its node.
        mode: ``play``, ``pause`` or ``stop``.
        url: address of the file; None for a tone.
        played: seconds of the sound that were played at the simulated time ``time`` (s).
    """

    component: str
    mode: str
    url: str | None
    played: float
    time: float

    _about: ClassVar[tuple[str, ...] | None] = ("component",)


class Capturing(ServerMessage, frozen=True):
    """Whether the cameras capture images."""

    active: bool


# the editor ----------------------------------------------------------------------------------------------


class Model(Struct, frozen=True):
    """A model that can be added.

    Attributes:
        group: ``robots``, ``sensors``, ``actuators``, or the name of a file with objects.
        doc: what it is, in a sentence.
        words: more words by which people look for it.
    """

    kind: str
    name: str
    group: str
    doc: str = ""
    words: str = ""


class Models(ServerMessage, frozen=True):
    """All models that can be added."""

    models: list[Model]


class ModelPicture(ServerMessage, frozen=True):
    """The address of the picture of a model."""

    kind: str
    url: str

    _about: ClassVar[tuple[str, ...] | None] = ("kind",)


class ComponentSettings(ServerMessage, frozen=True):
    """How a component can be set up.

    Attributes:
        settings: what can be called for it, with the present values of the arguments.
        own: method and first argument of what pages have called, which can be taken back.
        scripted: method and first argument of what the script has called.
    """

    component: str
    settings: list[SettingDescription]
    own: list[tuple[str, str]]
    scripted: list[tuple[str, str]]

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class SceneChanges(ServerMessage, frozen=True):
    """The changes of the scene since its script was run.

    Attributes:
        count: their number; 0 if all of them were saved.
        last: what was changed last; empty if there is nothing to undo.
        next: what was undone last; empty if there is nothing to make again.
        file: name of the file in which the scene is saved; empty if it cannot be saved.
    """

    count: int
    last: str
    next: str
    file: str


OF_COMPONENTS = frozenset(
    kind.__name__
    for kind in globals().values()
    if isinstance(kind, type)
    and issubclass(kind, ServerMessage)
    and (kind._about or ("",))[0] in ("component", "camera", "node")
)
"""The names of the messages about one component: the first part of the subject is the message, the second its name."""
