"""Protocols of the simulation for its own parts, which cannot import it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    from morse.core.clock import Clock
    from morse.core.context import Context
    from morse.core.journal import Journal
    from morse.core.observer import Observer
    from morse.core.services import Outcome
    from morse.physics import World
    from morse.recording.made.made import Made
    from morse.recording.recorder import Recorder
    from morse.scene import Scene
    from morse.simulation.handles.futures import LocalFuture
    from morse.simulation.handles.textures import NamedPictures
    from morse.simulation.loader import Loaded
    from morse.simulation.options import RunOptions
    from morse.simulation.states.state import State
    from morse.simulation.ticks.pacing import Pacer


class Holder(Protocol):
    """An object with a state."""

    def get_state(self) -> object:
        """Return the state as plain data."""

    def set_state(self, state: Any) -> None:
        """Restore a state that `get_state` returned."""


class Populated(Holder, Protocol):
    """The population of a simulation; see `morse.simulation.population.Population`."""

    check_kind: Callable[[str], object]

    def kinds(self) -> dict[str, str]:
        """See `morse.simulation.population.Population.kinds`."""

    def environments(self) -> list[str]:
        """See `morse.simulation.population.Population.environments`."""

    def restart(self, name: str, seed: int | None) -> None:
        """Restart one robot."""

    def set_state(self, state: Any, makers: Mapping[str, Callable[[], object]] = ...) -> None:
        """Spawn and delete robots and objects until they match the state."""

    def makers(self) -> Mapping[str, Callable[[], object]]:
        """Return the functions that created spawned objects."""

    def made(self) -> Mapping[str, Made]:
        """Return the present objects that were spawned."""

    def scene_at_launch(self) -> Scene:
        """Return the scene with the objects of the launch."""

    def roots_at_launch(self) -> list[str]:
        """Return the root objects of the launch."""

    def names_at_launch(self, without: Sequence[str]) -> list[str]:
        """Return the robots and components of the launch."""


class Running(Protocol):
    """The interface of `morse.simulation.simulation.Simulation` for its parts; documented there."""

    scene: Scene
    context: Context
    world: World
    clock: Clock
    options: RunOptions
    pacer: Pacer
    loaded: Loaded
    pictures: NamedPictures
    recorders: list[Recorder]

    @property
    def population(self) -> Populated:
        """The robots and objects."""

    @property
    def ticks(self) -> int:
        """Number of completed ticks since the start."""

    @property
    def paused(self) -> bool:
        """Whether `run` is paused."""

    @property
    def is_new(self) -> bool:
        """Whether nothing has happened since the launch or a restart."""

    @property
    def journal(self) -> Journal:
        """The journal of all input from outside."""

    @property
    def observers(self) -> list[Observer]:
        """The observers."""

    @property
    def before_physics(self) -> list[Callable[[], object]]:
        """Callbacks that are called in every tick before the physics."""

    def seed(self) -> int:
        """The seed of all random numbers."""

    def _check_open(self) -> None:
        """Raise an error if the simulation is closed."""

    def schedule(self) -> None:
        """Update the schedule after the components have changed."""

    def components_changed(self) -> None:
        """Called when robots were added or removed."""

    def finalize_one(self, part: object) -> None:
        """Finalize a component."""

    def viewpoint_changed(self) -> None:
        """Called when the camera of the scene was moved."""

    def tick(self) -> bool:
        """Run one tick."""

    def stop(self) -> None:
        """End `run` after this tick."""

    def measure_by_service(self, sensors: Sequence[str] | None, again: bool) -> None:
        """Let sensors measure between two ticks."""

    def pause(self) -> None:
        """Pause `run`."""

    def resume(self) -> None:
        """Resume `run`."""

    def cancel_steps(self) -> None:
        """Cancel the requested ticks."""

    def request_steps(self, ticks: int = 1, ended: Callable[[Outcome], object] = ...) -> Callable[[], None]:
        """Let `run` execute a number of ticks and then pause."""

    def call(self, component: str, service: str, *arguments: object) -> LocalFuture:
        """Call a service."""

    def set_controls(self, keys: frozenset[str], axes: tuple[float, ...] = (), robot: str | None = None) -> None:
        """Set keyboard and gamepad input."""

    def state_hash(self) -> str:
        """Return the SHA-256 of the state."""

    def save(self, path: str | os.PathLike[str] | None = None) -> State:
        """Return the state."""

    def silent_state(self) -> State:
        """The complete state, without warnings about values that cannot be saved."""

    def record(self, path: str | os.PathLike[str], sensors: Sequence[str] | None = None) -> Recorder:
        """Record the run in a file."""

    def restore(self, state: State | str | os.PathLike[str]) -> None:
        """Restore a state."""

    def arrange(self, state: State, *, described: bool) -> None:
        """Restore who is there and where, to show a recorded run."""

    def restart(self, seed: int | None = None) -> None:
        """Restart the simulation as after the launch."""

    def spawn(
        self,
        name: str,
        kind: str | Callable[[], object],
        position: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> object:
        """Spawn a robot or an object."""

    def delete(self, name: str) -> None:
        """Delete a robot or an object."""
