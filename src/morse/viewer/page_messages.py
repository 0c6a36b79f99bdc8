"""What a page says to the simulator.

Messages that change the simulation are accepted from the driving page alone and become events (`ViewEvent`).
"""

from __future__ import annotations

from typing import Annotated, Any

from msgspec import Meta, Struct

Name = Annotated[str, Meta(max_length=512)]
Request = Annotated[int, Meta(ge=0, le=2**53)]
Coordinate = Annotated[float, Meta(ge=-1e9, le=1e9)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Turn = tuple[Coordinate, Coordinate, Coordinate, Coordinate]


def snake_case(name: str) -> str:
    """``SetProperty`` to ``set_property``: the tag of a message on the wire."""
    return "".join("_" + letter.lower() if letter.isupper() else letter for letter in name).lstrip("_")


class PageMessage(Struct, frozen=True, tag_field="type", tag=snake_case):
    """A JSON object whose ``type`` says what it is."""


# the connection ------------------------------------------------------------------------------------------


class Hello(PageMessage, frozen=True):
    """The first message: the version of the protocol that the page speaks."""

    version: int


class Alive(PageMessage, frozen=True):
    """Sent several times a second; without it, keys are released."""


class Taken(PageMessage, frozen=True):
    """So many binary frames of poses have arrived since the connection began."""

    count: int


class Watch(PageMessage, frozen=True):
    """What the page shows, replacing what it showed before.

    Attributes:
        values: components whose data it wants.
        overlays: components whose rays, cones or other overlays the page shows, and ``contacts`` for contact points.
        images: cameras whose pictures it wants.
    """

    values: Annotated[list[Name], Meta(max_length=1000)] = []
    overlays: Annotated[list[Name], Meta(max_length=1000)] = []
    images: Annotated[list[Name], Meta(max_length=100)] = []


# the driving page ----------------------------------------------------------------------------------------------


class AskToDrive(PageMessage, frozen=True):
    """The page would like to drive."""


class HandOver(PageMessage, frozen=True):
    """The driving page lets another one drive."""

    to: int


class KeepDriving(PageMessage, frozen=True):
    """The driving page declines all that asked."""


class Keys(PageMessage, frozen=True):
    """The keys held down now, by their place on the keyboard (``KeyboardEvent.code``)."""

    held: Annotated[list[Annotated[str, Meta(max_length=40)]], Meta(max_length=32)]


class Gamepad(PageMessage, frozen=True):
    """The sticks and buttons of the gamepad that drives."""

    axes: Annotated[list[Annotated[float, Meta(ge=-1.0, le=1.0)]], Meta(max_length=32)]
    buttons: Annotated[list[bool], Meta(max_length=64)] = []


# events for the simulation -------------------------------------------------------------------------------


class ViewEvent(PageMessage, frozen=True):
    """Base of what the driving page asks of the simulation."""


class Play(ViewEvent, frozen=True):
    """Let time advance."""


class Pause(ViewEvent, frozen=True):
    """Stop time."""


class Step(ViewEvent, frozen=True):
    """While paused, advance by that many ticks."""

    count: Annotated[int, Meta(ge=1, le=10000)] = 1


class Rewind(ViewEvent, frozen=True):
    """Go to the state that is kept for a simulated time (s), or the last one before, and pause."""

    time: Annotated[float, Meta(ge=0.0)]


class StepBack(ViewEvent, frozen=True):
    """Go back to the state that was kept before the present one, and pause."""


class PlayBackward(ViewEvent, frozen=True):
    """Let a recorded run go backward."""


class Reset(ViewEvent, frozen=True):
    """Put everything back where the scene script had it."""


class SetSpeed(ViewEvent, frozen=True):
    """Simulated seconds per wall-clock second; None: as fast as possible."""

    factor: Annotated[float, Meta(gt=0.0, le=1000.0)] | None


class Quit(ViewEvent, frozen=True):
    """End the simulation."""


class ListenTo(ViewEvent, frozen=True):
    """Which robot obeys the keys; None: every one that can."""

    robot: Name | None


class SetProperty(ViewEvent, frozen=True):
    """Change a property of a component; answered."""

    request: Request
    component: Name
    name: Name
    value: Any


class Command(ViewEvent, frozen=True):
    """Set fields of the data of an actuator; answered."""

    request: Request
    component: Name
    fields: dict[Name, Any]


class CallService(ViewEvent, frozen=True):
    """Call a service of a component; answered when it ends."""

    request: Request
    component: Name
    service: Name
    arguments: list[Any] = []


class CancelService(ViewEvent, frozen=True):
    """Interrupt the service called with that request number."""

    request: Request


class Activate(ViewEvent, frozen=True):
    """Let a component work, or stop it; answered."""

    request: Request
    component: Name
    active: bool


class Teleport(ViewEvent, frozen=True):
    """Put a node somewhere: world frame, metres; quaternion w, x, y, z; answered."""

    request: Request
    node: Name
    position: Point
    quaternion: Turn


class Drag(ViewEvent, frozen=True):
    """Pull a point of a body towards a point of the world, as if by a spring, until `DragEnd`.

    Attributes:
        anchor: the point that is held, in the frame of the node, metres.
        target: where it is pulled to, in the world frame, metres.
    """

    node: Name
    anchor: Point
    target: Point


class DragEnd(ViewEvent, frozen=True):
    """Let go. Also issued when the page that drags is gone."""


class ToggleCapturing(ViewEvent, frozen=True):
    """Let all cameras take pictures, or stop them."""
