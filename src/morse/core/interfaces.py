"""The parts of a simulation, as the files below their classes see them.

`morse.core.object` imports the guard, the requests and the rows, which call components. They know components, robots,
modifiers and middlewares by these protocols.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, MutableSequence, Sequence

    from morse.core.clients.budgets import Arrivals, SensingBudget
    from morse.core.clients.complaints import Complaints
    from morse.core.clock import Clock
    from morse.core.services import ServiceDeclaration
    from morse.core.values import Fields
    from morse.core.world import Body, World
    from morse.core.world.world import Request
    from morse.helpers.transformation import Transformation3d
    from morse.scene import Scene, StreamDeclaration

_P = TypeVar("_P")
_R = TypeVar("_R")
_Call = TypeVar("_Call", bound="Callable[..., object]")


class Entry(Protocol):
    """An entry of the schedule with several components; see `morse.core.rows.rows.Rows`.

    Attributes:
        is_changed: whether a component has changed.
    """

    is_changed: bool

    def data_of(self, member: Component) -> Fields:
        """Return the data of a component."""

    def kept_of(self, member: Component) -> Fields:
        """Return the data of a component without casting or rendering anything for a reader."""

    def release(self) -> None:
        """Let all components act in each tick."""


class Acting(Protocol):
    """What acts at a rate: a component, or an entry of the schedule with several of them."""

    frequency: float

    def name(self) -> str:
        """The name in profiles and messages."""

    def action(self) -> None:
        """Perform one tick."""

    def switch_off(self) -> None:
        """End its actions, or change how they are called, after an error."""


class Guarding(Protocol):
    """Calls the code of users, and switches off the part that raises, see `morse.core.guard.Guard`."""

    def each(
        self, parts: Iterable[_P], call: Callable[[_P], object], off: Callable[[_P, BaseException], object]
    ) -> None:
        """Call a function with each part; ``off(part, error)`` switches off those for which it raises."""

    def those(
        self, parts: Iterable[_P], holds: Callable[[_P], object], off: Callable[[_P, BaseException], object]
    ) -> list[_P]:
        """Return the parts for which a condition holds; ``off(part, error)`` switches off those that cannot tell."""

    def run(self, function: Callable[[], _R], off: Callable[[BaseException], object]) -> _R | None:
        """Return the result of a function; None after ``off(error)`` if it raises."""

    def call(self, functions: MutableSequence[_Call], *arguments: object) -> None:
        """Call the functions of a list; one that raises is removed from it."""

    def deactivate(self, component: Acting, error: BaseException, culprit: object = None) -> None:
        """Switch off a component; ``culprit`` is its modifier that has raised the error, if any."""

    def close(
        self, component: Component, functions: MutableSequence[_Call], function: _Call, error: BaseException
    ) -> None:
        """Close a stream of a component, and nothing else."""


class Offering(Protocol):
    """An object that offers services, see `morse.core.abstractobject.AbstractObject`."""

    def name(self) -> str:
        """The name under which the services are offered."""

    def services(self) -> list[ServiceDeclaration]:
        """The services that it offers."""


class Modifier(Protocol):
    """Changes the data of a component, see `morse.core.modifier.AbstractModifier`."""

    @property
    def component_instance(self) -> Component:
        """The component."""

    def modify(self) -> None:
        """Change the data."""


class Simulated(Protocol):
    """The simulation of a component, see `morse.core.context.Context`."""

    @property
    def scene(self) -> Scene:
        """The scene."""

    @property
    def clock(self) -> Clock:
        """The simulated time."""

    @property
    def world(self) -> World:
        """The world."""

    @property
    def guard(self) -> Guarding:
        """Calls the code of users."""

    @property
    def arrivals(self) -> Arrivals:
        """The share of the time for what clients send."""

    @property
    def row_taps(self) -> list[Callable[..., object]]:
        """Callbacks, called after each action of sensors that measure when they are read."""

    @property
    def complaints(self) -> Complaints:
        """Warnings that clients may cause any number of times."""

    @property
    def sensing(self) -> SensingBudget:
        """The budget of pixels and rays for what clients set."""

    @property
    def strict(self) -> bool:
        """Whether an unknown or ill-typed field in a message is an error."""

    @property
    def paced(self) -> Callable[[], bool]:
        """Whether the simulation runs in step with the wall clock."""


class Component(Offering, Protocol):
    """A component, see `morse.core.object.Object`."""

    bge_object: Body
    local_data: Fields
    frequency: float
    position_3d: Transformation3d
    input_functions: list[Callable[..., object]]
    output_functions: list[Callable[..., object]]
    level: str | None
    running_service: str | None
    acts_in_rows: ClassVar[bool]
    _active: bool
    _in_rows: Entry | None
    _is_read: bool

    @property
    def context(self) -> Simulated:
        """The simulation."""

    @property
    def requests(self) -> Sequence[Request]:
        """The requests to servers."""

    @property
    def active(self) -> bool:
        """Whether it acts at all."""

    def action(self) -> None:
        """Perform one tick."""

    def is_wanted(self) -> bool:
        """Whether its requests are answered."""

    def may_wait(self) -> bool:
        """Whether the action may be omitted while it has nothing to do."""

    def switch_off(self) -> None:
        """Deactivate the component after an error."""


class Carrier(Component, Protocol):
    """A robot, see `morse.core.robot.Robot`."""

    is_dynamic: bool
    move_status: str

    def gettime(self) -> float:
        """Simulated time on the clock of this robot, s."""

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive the body during this tick: m/s along, and rad/s about, the axes of the robot."""

    def force_pose(self, position: Sequence[float] | None, orientation: Sequence[Sequence[float]] | None) -> None:
        """Place the robot at a pose in the world, at rest; None keeps the present position or orientation."""


class Stream(Protocol):
    """A stream of a component, see `morse.core.datastream.AbstractDatastream`."""

    @property
    def component_instance(self) -> Component:
        """The component."""

    def default(self, component: Component | None = None, /) -> object:
        """Publish the data, or read them."""


class Middleware(Protocol):
    """The streams of one middleware, see `morse.core.datastream.DatastreamManager`."""

    classpath: str

    def before_tick(self) -> None:
        """Called at the beginning of a tick."""

    def after_tick(self) -> None:
        """Called at the end of a tick."""

    def connect(self, component: Component, declaration: StreamDeclaration) -> None:
        """Open a stream for a component."""

    def disconnect(self, component: Component) -> None:
        """Close the streams of a component that is deleted."""

    @property
    def streams(self) -> Mapping[str, Sequence[Stream]]:
        """The open streams of each component, by name."""

    def drain(self) -> None:
        """Read everything that has arrived."""

    def push(self) -> None:
        """Send what earlier ticks have published."""

    def sent(self) -> dict[str, int]:
        """Return the number of messages sent per connection."""

    def close(self) -> None:
        """Send the remaining messages and close the connections."""
