"""Messages from pages to the simulator.

Messages that change the simulation are accepted only from the driving page, and become events (`ViewEvent`).
"""

from __future__ import annotations

from typing import Annotated, Any

from msgspec import Meta, Struct

Name = Annotated[str, Meta(max_length=512)]
Request = Annotated[int, Meta(ge=0, le=2**53)]
Coordinate = Annotated[float, Meta(ge=-1e9, le=1e9)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Factor = Annotated[float, Meta(gt=0.0, le=1e6)]
Turn = tuple[Coordinate, Coordinate, Coordinate, Coordinate]


def snake_case(name: str) -> str:
    """``SetProperty`` to ``set_property``: the tag of a message on the wire."""
    return "".join("_" + letter.lower() if letter.isupper() else letter for letter in name).lstrip("_")


class PageMessage(Struct, frozen=True, tag_field="type", tag=snake_case):
    """A JSON object with a ``type``."""


# the connection ------------------------------------------------------------------------------------------


class Hello(PageMessage, frozen=True):
    """The first message: the version of the protocol that the page speaks."""

    version: int


class Alive(PageMessage, frozen=True):
    """A heartbeat, sent several times per second; without it, keys are released."""


class Taken(PageMessage, frozen=True):
    """The number of binary pose frames received since the connection began."""

    count: int


class Shown(PageMessage, frozen=True):
    """The page has drawn the world for the first time."""


class Watch(PageMessage, frozen=True):
    """What the page shows; replaces the previous message.

    Attributes:
        values: components whose data are shown.
        overlays: components whose rays, cones or other overlays are shown, and ``contacts`` for contact points.
        images: cameras whose images are shown.
    """

    values: Annotated[list[Name], Meta(max_length=1000)] = []
    overlays: Annotated[list[Name], Meta(max_length=1000)] = []
    images: Annotated[list[Name], Meta(max_length=100)] = []


# the driving page ----------------------------------------------------------------------------------------------


class AskToDrive(PageMessage, frozen=True):
    """The page requests control."""


class HandOver(PageMessage, frozen=True):
    """The driving page hands control over to another page."""

    to: int


class KeepDriving(PageMessage, frozen=True):
    """The driving page declines all requests for control."""


class Keys(PageMessage, frozen=True):
    """The pressed keys, by their position on the keyboard (``KeyboardEvent.code``)."""

    held: Annotated[list[Annotated[str, Meta(max_length=40)]], Meta(max_length=32)]


class Gamepad(PageMessage, frozen=True):
    """The axes and buttons of the gamepad."""

    axes: Annotated[list[Annotated[float, Meta(ge=-1.0, le=1.0)]], Meta(max_length=32)]
    buttons: Annotated[list[bool], Meta(max_length=64)] = []


# events for the simulation -------------------------------------------------------------------------------


class ViewEvent(PageMessage, frozen=True):
    """Base of requests of the driving page to the simulation."""


class Play(ViewEvent, frozen=True):
    """Resume the simulation."""


class Pause(ViewEvent, frozen=True):
    """Stop time."""


class Step(ViewEvent, frozen=True):
    """While paused, run that many ticks."""

    count: Annotated[int, Meta(ge=1, le=10000)] = 1


class Rewind(ViewEvent, frozen=True):
    """Restore the state saved for a simulated time (s), or the last one before, and pause."""

    time: Annotated[float, Meta(ge=0.0)]


class StepBack(ViewEvent, frozen=True):
    """Restore the state saved before the present one, and pause."""


class PlayBackward(ViewEvent, frozen=True):
    """Play a recorded run backward."""


class Reset(ViewEvent, frozen=True):
    """Restart: restore the initial state of the scene script."""


class SetSpeed(ViewEvent, frozen=True):
    """Simulated seconds per wall-clock second; None: as fast as possible."""

    factor: Annotated[float, Meta(gt=0.0, le=1000.0)] | None


class Quit(ViewEvent, frozen=True):
    """End the simulation."""


class ListenTo(ViewEvent, frozen=True):
    """The robot that keys drive; None: all robots that can be driven."""

    robot: Name | None


class SetProperty(ViewEvent, frozen=True):
    """Change a property of a component; has an answer."""

    request: Request
    component: Name
    name: Name
    value: Any


class Command(ViewEvent, frozen=True):
    """Set fields of the data of an actuator; has an answer."""

    request: Request
    component: Name
    fields: dict[Name, Any]


class CallService(ViewEvent, frozen=True):
    """Call a service of a component; the answer is sent when it ends."""

    request: Request
    component: Name
    service: Name
    arguments: list[Any] = []


class CancelService(ViewEvent, frozen=True):
    """Interrupt the service called with that request number."""

    request: Request


class Activate(ViewEvent, frozen=True):
    """Activate or deactivate a component; has an answer."""

    request: Request
    component: Name
    active: bool


class Teleport(ViewEvent, frozen=True):
    """Set the pose of a node: world frame, metres; quaternion w, x, y, z; has an answer.

    Attributes:
        first: whether it begins a movement; all messages of a movement are undone together.
        group: changes with the same number, other than 0, one after another are undone together.
    """

    request: Request
    node: Name
    position: Point
    quaternion: Turn
    first: bool = True
    group: Request = 0


class Drag(ViewEvent, frozen=True):
    """Pull a point of a body towards a point of the world with a virtual spring, until `DragEnd`.

    Attributes:
        anchor: the attachment point in the frame of the node, metres.
        target: the target in the world frame, metres.
    """

    node: Name
    anchor: Point
    target: Point


class DragEnd(ViewEvent, frozen=True):
    """Stop pulling. Also issued when the page that pulls is disconnected."""


class ToggleCapturing(ViewEvent, frozen=True):
    """Let all cameras capture images, or stop them."""


# the editor ------------------------------------------------------------------------------------------------


class ListModels(ViewEvent, frozen=True):
    """Send the models that can be added, then their pictures."""


class AddModel(ViewEvent, frozen=True):
    """Add a model to the scene; the answer is its name.

    Attributes:
        model: the kind of a listed model.
        position: of its lowest point in the world, or of a component in the frame of what carries it, metres; None for
            a component at its usual place: an actuator in the origin of the robot, a sensor above it, both at the tip
            of an arm.
        yaw: radians.
        robot: the robot that gets the component, or a node that belongs to it: that of an arm or a pan-tilt unit, or a
            part of them, if that is to carry it.
        normal: of the surface of that node at the position, which is then in the world; None if no surface was pointed
            at.
        beside: whether an object goes beside what is already at the position, on the ground of that.
    """

    request: Request
    model: Name
    position: Point | None = None
    yaw: Coordinate = 0.0
    robot: Name = ""
    normal: Point | None = None
    beside: bool = False


class BeginUpload(ViewEvent, frozen=True):
    """Files of a model are to be sent; the answer is the number of the upload, with which they are sent.

    Attributes:
        name: of the model: that of its folder, or of its file without the suffix.
        files: path and size of each, bytes; paths are relative, with ``/``.
    """

    request: Request
    name: Name
    files: Annotated[list[tuple[Name, Annotated[int, Meta(ge=0)]]], Meta(min_length=1, max_length=1000)]


class UploadPart(ViewEvent, frozen=True):
    """The next bytes of a file; has an answer.

    Attributes:
        upload: the answer of `BeginUpload`.
        file: index of the file.
        data: as base64.
    """

    request: Request
    upload: int
    file: Annotated[int, Meta(ge=0)]
    data: Annotated[str, Meta(max_length=200_000)]


class ExamineUpload(ViewEvent, frozen=True):
    """All files were sent; the answer lists what can be added of them, and what is to be said about each file.

    ``[{"file", "error", "contents": [[title, text], ...], "kinds": [kind, ...]}, ...]``
    """

    request: Request
    upload: int


class DeleteObject(ViewEvent, frozen=True):
    """Delete a robot, an object or a component; the answer is its name. For ``group`` see `Teleport`."""

    request: Request
    node: Name
    group: Request = 0


class ScaleObject(ViewEvent, frozen=True):
    """Multiply the size of an object that a page has added, along its axes; the answer is its name."""

    request: Request
    node: Name
    factors: tuple[Factor, Factor, Factor]
    group: Request = 0


class UndoChange(ViewEvent, frozen=True):
    """Undo the last change of the scene; the answer is what it was."""

    request: Request


class RedoChange(ViewEvent, frozen=True):
    """Make the change again that was undone last; the answer is what it was."""

    request: Request


class DuplicateObject(ViewEvent, frozen=True):
    """Put another robot or object like one that a page has added beside it; the answer is its name."""

    request: Request
    node: Name
    group: Request = 0


class ListSettings(ViewEvent, frozen=True):
    """Send how a component can be set up."""

    component: Name


class Configure(ViewEvent, frozen=True):
    """Call a method of the builder for a component, which is created anew with it; has an answer.

    Attributes:
        method: ``frequency``, ``level``, ``noise``, ``delay``, ``phase``, ``alter`` or ``add_stream``.
        values: arguments by name; that with an empty name is the first one.
        remove: whether an earlier call, with the same first argument, is taken back.
    """

    request: Request
    component: Name
    method: Name
    values: dict[Name, Any] = {}
    remove: bool = False


class ShowScript(ViewEvent, frozen=True):
    """Send the script as it would be saved.

    The answer has ``file``, ``text``, the ``lines`` of each object, why it is ``locked`` for `ChangeScript` (empty if
    it is not), and its ``version``.
    """

    request: Request


class ChangeScript(ViewEvent, frozen=True):
    """Write a text in place of the script, or only show the lines that would change.

    The answer has ``path``, ``difference`` and ``folders`` as that of `SaveScene`; whether the script ``runs``, so that
    a restart loads it; and the ``error`` and its ``line`` if it is not Python: then nothing is written.

    Attributes:
        version: of the text that was changed: what has changed meanwhile is not overwritten.
    """

    request: Request
    text: Annotated[str, Meta(max_length=250_000)]
    version: Name
    write: bool


class SaveScene(ViewEvent, frozen=True):
    """Write the changes into the script of the scene, or only show the lines that would change; has an answer."""

    request: Request
    write: bool
