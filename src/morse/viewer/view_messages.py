"""What the simulator says to the pages."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from msgspec import Struct

from morse.viewer.page_messages import snake_case

Subject = tuple[str, ...]


class ServerMessage(Struct, frozen=True, tag_field="type", tag=snake_case):
    """A JSON object whose ``type`` says what it is.

    Of two messages with the same subject only the newer one matters: a page that is slow gets that one alone.
    """

    _about: ClassVar[tuple[str, ...] | None] = ()
    """The fields that tell the subjects of such messages apart; None: every message counts."""

    _lasting: ClassVar[bool] = True

    def subject(self) -> Subject | None:
        """What the message is about, or None if every one counts."""
        return None if self._about is None else (type(self).__name__, *(getattr(self, name) for name in self._about))

    @property
    def lasting(self) -> bool:
        """Told also to pages that come later."""
        return self._lasting


class Payload(ServerMessage, frozen=True):
    """A message that ends with numbers or a picture: sent as a binary frame."""

    payload: bytes


# the connection ------------------------------------------------------------------------------------------


class Welcome(ServerMessage, frozen=True):
    """Answers the page's `Hello`; ``page`` is the number by which the others know it."""

    version: int
    page: int
    title: str


class World(ServerMessage, frozen=True):
    """There is a new world: fetch its description."""

    revision: int
    url: str


class Seat(ServerMessage, frozen=True):
    """Which page drives, which pages have asked to drive, and the number of pages."""

    driver: int | None
    asking: list[int]
    pages: int


class Refused(ServerMessage, frozen=True):
    """Something that the page asked for was not done."""

    what: str
    why: str

    _about: ClassVar[tuple[str, ...] | None] = None
    _lasting: ClassVar[bool] = False


# time and news -------------------------------------------------------------------------------------------


class Pace(ServerMessage, frozen=True):
    """How well the simulation keeps up.

    Attributes:
        strategy: e.g. ``Best Effort``.
        late: wall-clock seconds behind; 0 when it keeps up.
        cause: what takes the time, as a clause; empty if nothing in particular does.
    """

    strategy: str
    late: float = 0.0
    cause: str = ""


class RecordingDescription(Struct, frozen=True):
    """A recording that is being written.

    Attributes:
        path: absolute.
        seconds: simulated seconds in it.
        bytes: of the file; data that wait to be written are not counted.
        stoppable: whether the service ``stop_recording`` ends it.
    """

    path: str
    seconds: float
    bytes: int
    stoppable: bool


class Recordings(ServerMessage, frozen=True):
    """The recordings that are being written now; none for a simulation that cannot be recorded."""

    recordings: list[RecordingDescription]
    possible: bool = True


class History(ServerMessage, frozen=True):
    """The simulated times (s) of the states that can be gone back to, oldest first.

    Attributes:
        times: for a recorded run, times all along it, also ahead of the present one.
        recorded: whether the run is a recorded one, which can be played backward, too.
    """

    times: list[float]
    recorded: bool = False


class Log(ServerMessage, frozen=True):
    """A line of the log.

    Attributes:
        component: the component that the line is about, or empty.
        time: simulated seconds.
        place: counts lines modulo the number of lines that are kept for pages that connect later.
    """

    level: Literal["debug", "info", "warning", "error"]
    text: str
    component: str = ""
    time: float = 0.0
    place: int = 0

    _about: ClassVar[tuple[str, ...] | None] = ("place",)


class DebugProperty(Struct, frozen=True):
    """A property of an object, with its value as text."""

    node: str
    name: str
    value: str


class DebugProperties(ServerMessage, frozen=True):
    """The properties that the script asks to show; there are ``more`` than these."""

    properties: list[DebugProperty]
    more: int = 0


# components ----------------------------------------------------------------------------------------------


class FieldDescription(Struct, frozen=True):
    """A data field of a component; ``low`` and ``high`` bound what it may hold."""

    name: str
    type: str = ""
    doc: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None


class PropertyDescription(Struct, frozen=True):
    """A property of a component, with its value now; ``choices`` are all values that it may have, if they are few."""

    name: str
    type: str = ""
    doc: str = ""
    value: Any = None
    choices: list[Any] | None = None
    unit: str = ""
    low: float | None = None
    high: float | None = None


class ArgumentDescription(Struct, frozen=True):
    """An argument of a service; ``default`` is written as in Python, None if it must be given."""

    name: str
    type: str = ""
    default: str | None = None


class ServiceDescription(Struct, frozen=True):
    """A service of a component."""

    name: str
    doc: str = ""
    arguments: list[ArgumentDescription] = []
    asynchronous: bool = False


class ComponentDescription(Struct, frozen=True):
    """A robot, sensor or actuator.

    Attributes:
        name: fully qualified; also the name of its node in the scene.
        kind: ``robot``, ``external_robot``, ``sensor`` or ``actuator``.
        robot: the name of the robot that carries it.
        title: name of its class, for people.
        frequency: Hz.
    """

    name: str
    kind: str
    robot: str
    title: str = ""
    doc: str = ""
    frequency: float = 0.0
    level: str = ""
    active: bool = True
    data: list[FieldDescription] = []
    properties: list[PropertyDescription] = []
    services: list[ServiceDescription] = []


class Tree(ServerMessage, frozen=True):
    """All components, and services that belong to none (``simulation``, ``time``)."""

    components: list[ComponentDescription]


class Listening(ServerMessage, frozen=True):
    """The robots that can obey keys, and the one that does (None: all of them)."""

    robots: list[str]
    robot: str | None = None


class Values(ServerMessage, frozen=True):
    """Data of a component at a simulated time (s)."""

    component: str
    time: float
    data: dict[str, Any]

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class PropertyValue(ServerMessage, frozen=True):
    """A property changed."""

    component: str
    name: str
    value: Any

    _about: ClassVar[tuple[str, ...] | None] = ("component", "name")


class Activity(ServerMessage, frozen=True):
    """A component works now, or no longer."""

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
    """A service has moved the camera that scripts place.

    Attributes:
        location: world frame, metres.
        rotation: Euler angles XYZ of a camera that looks along its -Z, radians.
        clip: nearest and farthest distance that is drawn, metres.
    """

    location: tuple[float, float, float]
    rotation: tuple[float, float, float]
    clip: tuple[float, float]


class Appearance(ServerMessage, frozen=True):
    """A node is hidden, shown or recoloured (linear RGBA, None: as its materials are)."""

    node: str
    visible: bool
    color: tuple[float, float, float, float] | None = None

    _about: ClassVar[tuple[str, ...] | None] = ("node",)


class Rays(Payload, frozen=True):
    """The rays of a sensor: (N, 7) float32 of origin, end (m, world frame) and 1 where something was hit."""

    component: str

    _about: ClassVar[tuple[str, ...] | None] = ("component",)
    _lasting: ClassVar[bool] = False


class Contacts(Payload, frozen=True):
    """Where bodies touch: (N, 6) float32 of point (m) and force (N), both in the world frame."""

    _lasting: ClassVar[bool] = False


class Cone(ServerMessage, frozen=True):
    """The space that a sensor watches, around the X axis of its node.

    Attributes:
        reach: metres.
        angle: full opening angle, radians; 2 pi for a sphere.
        seen: names of what it sees now.
    """

    component: str
    reach: float
    angle: float
    seen: list[str] = []

    _about: ClassVar[tuple[str, ...] | None] = ("component",)


class Frustum(ServerMessage, frozen=True):
    """The field of view of a camera.

    Attributes:
        rim: directions of the border of the picture as unit vectors in the frame of the camera (X right, Y down,
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
    """An object that a camera has recognised in its picture.

    Attributes:
        id: of its pixels.
        kind: its class; empty if it has none.
        box: x0, y0, x1, y1, px from the upper left corner; x1 and y1 are the first ones outside.
    """

    id: int
    name: str
    kind: str
    box: tuple[float, float, float, float]


class Picture(Payload, frozen=True):
    """What a camera sees.

    Attributes:
        mime: ``image/jpeg``, ``image/png``, ``image/x-rgba`` for bare rows of 8-bit RGBA, or ``image/x-u16`` for
            bare rows of little-endian uint16, compressed by zlib; the top row is first.
        meaning: of the pixels. Depth is 8-bit: 255 stands for ``low``, `FARTHEST_LEVEL` for ``high``, and pixels
            without depth are black. Ids are 16-bit, 0 for none.
        low, high: the least and the greatest depth in the picture, in ``unit``.
        sightings: what the camera has recognised.
    """

    camera: str
    width: int
    height: int
    mime: str
    time: float = 0.0
    meaning: Literal["color", "depth", "ids"] = "color"
    low: float = 0.0
    high: float = 0.0
    unit: str = ""
    sightings: list[Sighting] = []

    _about: ClassVar[tuple[str, ...] | None] = ("camera",)
    _lasting: ClassVar[bool] = False


class Capturing(ServerMessage, frozen=True):
    """Whether the cameras take pictures."""

    active: bool
