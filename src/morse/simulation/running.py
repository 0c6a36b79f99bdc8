"""A simulation as its own parts see it, which are below it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.clock import Clock
    from morse.core.context import Context
    from morse.core.journal import Journal
    from morse.core.observer import Observer
    from morse.physics import World
    from morse.recording.recorder import Recorder
    from morse.scene import Scene
    from morse.simulation.futures import LocalFuture
    from morse.simulation.loader import Loaded
    from morse.simulation.options import RunOptions
    from morse.simulation.pacing import Pacer
    from morse.simulation.state import State


class Holder(Protocol):
    """Something that has a state."""

    def get_state(self) -> Any:
        """All that determines its future, as plain data."""

    def set_state(self, state: Any) -> None:
        """Take a state from `get_state`."""


class Populated(Holder, Protocol):
    """Who is in a simulation; see `morse.simulation.population.Population`."""

    def set_state(self, state: Any, makers: Mapping[str, Callable[[], Any]] = ...) -> None:
        """Let robots and things come and go until those of the state are there."""

    def makers(self) -> Mapping[str, Callable[[], Any]]:
        """The functions that made newcomers."""

    def roots_at_launch(self) -> list[str]:
        """The objects that were there at the launch."""

    def names_at_launch(self, without: Sequence[str]) -> list[str]:
        """The robots and components that were there at the launch."""


class Running(Protocol):
    """What the parts of `morse.simulation.simulation.Simulation` need of it; it is described there."""

    scene: Scene
    context: Context
    world: World
    clock: Clock
    options: RunOptions
    pacer: Pacer
    loaded: Loaded
    recorders: list[Recorder]

    @property
    def population(self) -> Populated:
        """Who is there."""

    @property
    def ticks(self) -> int:
        """Number of ticks done since the start."""

    @property
    def paused(self) -> bool:
        """Whether no time passes in `run`."""

    @property
    def journal(self) -> Journal:
        """Everything that comes in from outside."""

    @property
    def observers(self) -> list[Observer]:
        """Who looks on."""

    @property
    def before_physics(self) -> list[Callable[[], object]]:
        """Called in every tick before the physics."""

    def seed(self) -> int:
        """The seed of all random numbers."""

    def _check_open(self) -> None:
        """Refuse to go on if the simulation is closed."""

    def schedule(self) -> None:
        """The components are other ones."""

    def components_changed(self) -> None:
        """Robots have come or gone."""

    def finalize_one(self, part: Any) -> None:
        """Tell a component that its time is over."""

    def viewpoint_changed(self) -> None:
        """The camera of the scene was moved."""

    def tick(self) -> bool:
        """One tick."""

    def stop(self) -> None:
        """End `run` after this tick."""

    def pause(self) -> None:
        """Stop time in `run`."""

    def resume(self) -> None:
        """Let time pass again in `run`."""

    def cancel_steps(self) -> None:
        """Do no more of the ticks that were asked for."""

    def request_steps(self, ticks: int = 1, ended: Callable[[tuple[str, Any]], object] = ...) -> Callable[[], None]:
        """Let `run` do that many ticks and no more."""

    def call(self, component: str, service: str, *arguments: Any) -> LocalFuture:
        """Call a service."""

    def set_controls(self, keys: frozenset[str], axes: tuple[float, ...] = (), robot: str | None = None) -> None:
        """What a person does at the live view."""

    def state_hash(self) -> str:
        """SHA-256 of all that determines the future."""

    def save(self, path: str | os.PathLike[str] | None = None) -> State:
        """All that determines the future."""

    def record(self, path: str | os.PathLike[str], sensors: Sequence[str] | None = None) -> Recorder:
        """Record the run in a file."""

    def restore(self, state: State | str | os.PathLike[str]) -> None:
        """Go on from a state."""

    def restart(self, seed: int | None = None) -> None:
        """Everything as after the launch."""

    def spawn(
        self,
        name: str,
        kind: str | Callable[[], Any],
        position: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> Any:
        """Let a robot or a thing come."""

    def delete(self, name: str) -> None:
        """Let a robot or a thing go."""
