"""A running simulation, as components see it."""

from __future__ import annotations

import hashlib
import logging
import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, TypeVar, cast
from weakref import WeakSet

from morse.core.classes.fixed import check_class
from morse.core.clients.budgets import Arrivals, SensingBudget, TimeShares
from morse.core.clients.complaints import Complaints
from morse.core.guard import Guard
from morse.core.journal import Journal

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    import numpy as np

    from morse.core.abstractobject import AbstractObject
    from morse.core.clients.network import Network
    from morse.core.clock import Clock
    from morse.core.interfaces import Carrier, Middleware
    from morse.core.object import Object
    from morse.core.overlay import MorseOverlay
    from morse.core.request_manager import MorseServices
    from morse.core.world import World
    from morse.scene import Scene

logger = logging.getLogger("morse.simulation")

_S = TypeVar("_S")


class Controls(NamedTuple):
    """Keyboard and gamepad input at the live view.

    Attributes:
        keys: names of the keys that are pressed (``ArrowUp``).
        axes: axes of the gamepad, -1 to 1, right and down positive; empty without a gamepad.
        robot: name of the robot that the keys control, or None for all robots.
    """

    keys: frozenset[str] = frozenset()
    axes: tuple[float, ...] = ()
    robot: str | None = None


_CALLBACKS = frozenset(("stopping", "paused", "paced"))
_NOTHING_HELD = Controls()


def _not_stopping() -> bool:
    return False


@dataclass(eq=False)
class Context:
    """One simulation: its clock, its components, its services.

    Attributes:
        robots: robots by name; ``external_robots`` are simulated by other simulation nodes.
        components: sensors and actuators by fully qualified name.
        stream_managers: by class path.
        service_objects: objects that offer the services of ``simulation``, ``time`` and ``communication``; several
            objects may share a name.
        row_taps: callbacks, called after each action of sensors that measure when they are read, with their
            `morse.core.rows.rows.SensorRows`.
        network: the network thread for sockets and the live view; None for a simulation without either.
        failed: names of the components that were deactivated because they raised exceptions.
        controls: input at the live view; it changes between ticks only.
        journal: record of all input from outside the simulation.
        guard: calls the code of users, and switches off the part that raises.
        image_workers: number of processes that render the images of cameras, 0 if this process does; or the address of
            a cluster.
        strict: whether an unknown or ill-typed field in a message is an error, not only a warning.
        stopping: whether the simulation was asked to end; code that waits within a tick has to check it.
        settling: whether robots still fall to the floor after the start of a run, so that clients get no messages yet.
        paused: whether no time passes except for the ticks that a client requests.
        paced: whether the simulation runs in step with the wall clock, and waits between ticks.
        seed: seed of all random numbers.
        file_label: what the names of files that streams write get before their suffix, such as ``-row3`` in a batch;
            None if they write no files, because the simulation is a copy of another one.
        drawn: names of the generators of random numbers, whose states depend on the seed.
        robot_seeds: seeds of the robots that have been restarted with seeds of their own.
        arrivals: the share of the time for what clients send.
        time_shares: the shares of the time of the ticks for services.
        sensing: the budget of pixels and rays for what clients set.
        complaints: warnings of components that clients may cause any number of times, by commands or by resets.
    """

    scene: Scene
    clock: Clock
    world: World
    services: MorseServices
    network: Network = None  # type: ignore[assignment] # who uses it has been made for a simulation that has one
    seed: int = 0
    drawn: set[str] = field(default_factory=set, init=False)
    robot_seeds: dict[str, int] = field(default_factory=dict)
    host: str = "127.0.0.1"
    file_label: str | None = ""
    strict: bool = False
    image_workers: int | str = 0
    robots: dict[str, Carrier] = field(default_factory=dict)
    external_robots: dict[str, Object] = field(default_factory=dict)
    components: dict[str, Object] = field(default_factory=dict)
    stream_managers: dict[str, Middleware] = field(default_factory=dict)
    service_objects: list[AbstractObject] = field(default_factory=list)
    row_taps: list[Callable[..., object]] = field(default_factory=list)
    overlays: dict[str, MorseOverlay] = field(default_factory=dict)
    failed: set[str] = field(default_factory=set)
    controls: Controls = _NOTHING_HELD
    journal: Journal = field(init=False)
    arrivals: Arrivals = field(init=False)
    guard: Guard = field(init=False)
    stopping: Callable[[], bool] = _not_stopping
    paused: Callable[[], bool] = _not_stopping
    settling: bool = False
    paced: Callable[[], bool] = _not_stopping
    complaints: Complaints = field(default_factory=lambda: Complaints(logger))
    time_shares: TimeShares = field(default_factory=TimeShares)
    sensing: SensingBudget = field(init=False)
    _servers: dict[object, object] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Context of {self.scene!r}>"

    def __post_init__(self) -> None:
        self.guard = self.services.guard = Guard(self)
        self.sensing = SensingBudget(lambda: self.components.values())
        self.journal = Journal(self.clock, self.guard)
        self.arrivals = Arrivals() if self.network is None else self.network.arrivals
        _alive.add(self)

    def __setattr__(self, name: str, value: object) -> None:
        # a component that puts None in the place of a part would stop all others
        if name not in _CALLBACKS:
            check_class(self, name, value)
        self.__dict__[name] = value

    def wait(self, seconds: float) -> None:
        """Block the simulation thread until something arrives from the network, or for about ``seconds``."""
        if self.network is not None:
            self.network.wait(seconds)

    def wake(self) -> None:
        """End `wait`, because something has arrived; may be called from any thread."""
        if self.network is not None:
            self.network.wake()

    def component(self, name: str) -> Object | None:
        """The robot, sensor or actuator of that name, or None."""
        # a component of the user may define its truth or its length
        component = self.components.get(name)
        return cast("Object | None", self.robots.get(name)) if component is None else component

    def server(self, kind: Callable[..., _S]) -> _S:
        """Return the server for requests of components (see `morse.core.requests`).

        Args:
            kind: class of the server; it is called with the world. One instance per class is created, at the first
                call.
        """
        if kind not in self._servers:
            self._servers[kind] = kind(self.world)
        return cast("_S", self._servers[kind])

    def close_servers(self) -> None:
        """Release what servers hold besides memory: those with a method ``close``."""
        for server in self._servers.values():
            if (close := getattr(server, "close", None)) is not None:
                close()

    def random(self, name: str) -> np.random.Generator:
        """Return a generator of random numbers that depends only on the seed and ``name``, which begins with its user.

        Adding a component to a scene does not change the random numbers of other components.
        """
        self.drawn.add(name)
        return self.random_at(name)

    def random_at(self, name: str, moment: int | None = None) -> np.random.Generator:
        """Return a generator that is used up at once: its numbers also depend on ``moment``, such as a tick.

        It is no state: who draws from it does not have to be created again by a restart with another seed.
        """
        import numpy as np

        if moment is not None:
            name = f"{name}/{moment}"
        own = (seed for robot, seed in self.robot_seeds.items() if name.startswith((f"{robot}.", f"{robot}/")))
        digest = hashlib.sha256(f"{next(own, self.seed)}/{name}".encode("utf-8", "surrogatepass")).digest()
        return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))


_alive: WeakSet[Context] = WeakSet()


def forget(context: Context) -> None:
    """Remove a simulation that has ended, so that `current` does not return it any more."""
    _alive.discard(context)


class _Acting(threading.local):
    context: Context | None = None


_acting = _Acting()


class acting:  # noqa: N801 (used as a statement: ``with acting(context):``)
    """While the block runs, `current` returns this simulation in this thread."""

    __slots__ = ("_before", "_context")

    def __init__(self, context: Context) -> None:
        self._context = context

    def __enter__(self) -> None:
        self._before = _acting.context
        _acting.context = self._context

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _acting.context = self._before


def current() -> Context:
    """Return the simulation whose components are acting, or being created, in this thread.

    Components use ``self.context``. This function is for code of MORSE 1.4, where a process had one simulation only. If
    such code runs in a thread of its own, the function returns the only simulation of the process.

    Raises:
        RuntimeError: no simulation acts in this thread, and there is not exactly one in the process.
    """
    if _acting.context is not None:
        return _acting.context
    alive = list(_alive)
    if len(alive) == 1:
        return alive[0]
    if not alive:
        raise RuntimeError(
            "no simulation is running: components are created by morse.load or 'morse run', not directly"
        )
    raise RuntimeError(
        f"{len(alive)} simulations are running, and none of them acts in this thread: use self.context of a component"
    )
