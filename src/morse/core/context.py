"""The running simulation, as components see it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np

    from morse.core.abstractobject import AbstractObject
    from morse.core.clock import Clock
    from morse.core.network import Network
    from morse.core.object import Object
    from morse.core.request_manager import MorseServices
    from morse.core.robot import Robot
    from morse.scene import Scene


class WorldView(Protocol):
    """What core needs of the physics world (see `morse.physics.World`)."""

    def game_object(self, name: str) -> Any:
        """The object of that name."""


def _no_keys() -> frozenset[str]:
    return frozenset()


def _no() -> bool:
    return False


def _no_gamepad() -> tuple[float, ...]:
    return ()


def _any_robot() -> str | None:
    return None


@dataclass(eq=False)
class Context:
    """One simulation: its clock, its components, its services.

    Attributes:
        robots: by name; ``external_robots`` are run by other simulation nodes.
        components: sensors and actuators by fully qualified name.
        stream_managers: by class path.
        service_objects: pseudo components: ``simulation``, ``time``, ``communication``.
        held_keys: names of the keys that are held down in the live view (``ArrowUp``).
        gamepad: axes of the gamepad at the live view, -1 to 1, right and down positive; empty without one.
        listening_robot: name of the robot that the keys drive, or None for all.
        stopping: whether the simulation has been told to end; what waits within a tick has to ask.
        seed: of all random numbers.
    """

    scene: Scene
    clock: Clock
    world: Any
    services: MorseServices
    network: Network
    seed: int = 0
    host: str = "127.0.0.1"
    robots: dict[str, Robot] = field(default_factory=dict)
    external_robots: dict[str, Robot] = field(default_factory=dict)
    components: dict[str, Object] = field(default_factory=dict)
    stream_managers: dict[str, Any] = field(default_factory=dict)
    service_objects: dict[str, AbstractObject] = field(default_factory=dict)
    overlays: dict[str, Any] = field(default_factory=dict)
    held_keys: Callable[[], frozenset[str]] = _no_keys
    gamepad: Callable[[], tuple[float, ...]] = _no_gamepad
    listening_robot: Callable[[], str | None] = _any_robot
    stopping: Callable[[], bool] = _no

    def wait(self, seconds: float) -> None:
        """Let the simulation thread wait until something arrives from the network, or for about that long."""
        self.network.wait(seconds)

    def wake(self) -> None:
        """Something has arrived: end `wait`; may be called from any thread."""
        self.network.wake()

    def random(self, name: str) -> np.random.Generator:
        """A generator of random numbers that depends on nothing but the seed and ``name``.

        Adding a component to a scene changes the numbers of no other component.
        """
        import numpy as np

        digest = hashlib.sha256(f"{self.seed}/{name}".encode()).digest()
        return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))


_current: Context | None = None


def set_current(context: Context | None) -> None:
    """Make ``context`` the one that new components belong to."""
    global _current
    _current = context


def current() -> Context:
    """The running simulation.

    Raises:
        RuntimeError: outside a simulation.
    """
    if _current is None:
        raise RuntimeError("no simulation is running: components are made by 'morse run', not by hand")
    return _current
