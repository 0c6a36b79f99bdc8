"""The topics of each message kind: a table of methods that each describe the topics of some kinds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from morse.core.kinds.table import GENERAL
from morse.core.mapping import IN, OUT, mapped_kinds, maps

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.outlets import Inlet, Outlet

_F = TypeVar("_F", bound="Callable[..., Any]")

#: attribute of a method that describes topics
_MARK = "_morse_topics"


class Carrier(Protocol):
    """The component whose messages are carried, as the methods of a table see it."""

    @property
    def component_name(self) -> str:
        """Name of the component."""

    @property
    def kwargs(self) -> Mapping[str, object]:
        """Options of the stream."""

    @property
    def kinds(self) -> Sequence[BoundKind]:
        """All message kinds of the component."""

    def odometry(self, message: Message, frame: str) -> RosMessage:
        """``nav_msgs/Odometry`` of the robot."""

    def odometry_numbers(self, message: Message) -> tuple[float, ...]:
        """The numbers of `odometry`."""


def topics(*kinds: str, direction: str = OUT) -> Callable[[_F], _F]:
    """Declare that a method of a `TopicTable` describes the topics of some kinds.

    It is called with the `Carrier` and the `BoundKind`, and returns instances of `Outlet`; with ``direction="IN"``
    instances of `Inlet`.
    """
    return maps(*kinds, direction=direction, mark=_MARK)


class TopicTable:
    """The topics of all kinds."""

    _methods: ClassVar[dict[tuple[str, str], str]] = {}

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._methods = mapped_kinds(cls, _MARK, needs_general=False)

    @classmethod
    def has(cls, kind: str, direction: str = OUT) -> bool:
        """Whether a method names the kind."""
        return (kind, direction) in cls._methods

    def outlets(self, carrier: Carrier, bound: BoundKind) -> list[Outlet]:
        """The topics that publish a kind; those of ``general`` for a kind that no method names."""
        return self._ports(carrier, bound, OUT)  # type: ignore[return-value]

    def inlets(self, carrier: Carrier, bound: BoundKind) -> list[Inlet]:
        """The topics for commands of a kind."""
        return self._ports(carrier, bound, IN)  # type: ignore[return-value]

    def _ports(self, carrier: Carrier, bound: BoundKind, direction: str) -> list[Outlet] | list[Inlet]:
        methods = self._methods
        name = methods.get((bound.kind.name, direction)) or methods.get((GENERAL, direction))
        return [] if name is None else list(getattr(self, name)(carrier, bound))
