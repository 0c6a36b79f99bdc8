"""A simulation, as an object."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.clock import Clock
from morse.core.context import Context, Controls, acting, forget
from morse.core.journal import CONTROLS, DELETE, RESET, RESTORE, SPAWN
from morse.core.request_manager import MorseServices
from morse.middleware.registry import needs_network
from morse.physics import World
from morse.simulation.component_handles import normalized
from morse.simulation.faults import describe
from morse.simulation.handles import Handles
from morse.simulation.loader import Loaded, LoadError, connect, load_components, make_stream_manager
from morse.simulation.loop import Loop
from morse.simulation.offering import offer_services
from morse.simulation.ownership import Ownership
from morse.simulation.population import Population, check_newcomer
from morse.simulation.profile import Profile
from morse.simulation.recorded import Recorded
from morse.simulation.saving import Saving
from morse.simulation.state import State
from morse.simulation.stepping import Stepping
from morse.simulation.ticking import Ticker

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence
    from types import TracebackType

    from morse.core.journal import Journal
    from morse.core.observer import Observer
    from morse.scene import Scene
    from morse.simulation.options import RunOptions


logger = logging.getLogger(__name__)


def _nobody(_outcome: tuple[str, Any]) -> None:
    """Nobody waits for the end of the steps."""


class Simulation(Recorded, Handles):
    """A loaded scene that can be run; `morse.load` makes one.

    Robots are attributes, and their components are attributes of them, with the words of `pymorse.Morse`: see
    `morse.simulation.handles`. Time passes in `step` and `run` only.

    Attributes:
        context: what components see.
        observers: look on; called before and after each tick, in their order.
        view: the live view, if there is one; it is one of the observers.
        failed: whether the simulation has to end because a part of it cannot go on.
    """

    def __init__(self, scene: Scene, options: RunOptions) -> None:
        settings = scene.settings
        self.options = options
        self.scene = scene
        self.context = Context(
            scene=scene,
            clock=Clock(settings.frequency, settings.time_strategy, absolute=not settings.relative_time),
            world=World(scene),
            services=MorseServices(),
            network=_network(options),
            seed=settings.seed if options.seed is None else options.seed,
            host=options.host,
            strict=options.strict,
        )
        self.world: World = self.context.world
        self.clock = self.context.clock
        self._stepping = Stepping()
        self._ticker = Ticker(self.context, self._stepping)
        speed = settings.time_scale if options.speed is None else options.speed
        self._loop = Loop(self.context, self._ticker, self._stepping, speed)
        self.pacer = self._loop.pacer
        self.context.stopping = lambda: self._loop.stopping
        self.view: Any = None
        #: loads the edited scene in the place of this one; False if there is nothing new to load
        self.reread: Callable[[], bool] | None = None
        self.profile: Profile | None = None
        #: measures the sensors that the script wants to be profiled
        self.sensor_profile = Profile() if any(d.profile for d in scene.components) else None
        self._set_up_profiles()
        self.failed = self.finished = False
        self._time = Ownership(self.stop)
        self.loaded = Loaded()
        super().__init__()
        self.population = Population(self)
        self._saving = Saving(self)
        with acting(self.context):
            offer_services(self)

    def _set_up_profiles(self) -> None:
        if self.options.profile:
            self.profile = Profile(trace=True)
            self._ticker.profiles.append(self.profile)
        self._ticker.component_profiles += [p for p in (self.profile, self.sensor_profile) if p is not None]

    def load(self) -> None:
        """Make the components and connect them.

        Raises:
            LoadError: naming the component and the line of the script that made it.
        """
        with acting(self.context), self.scene.project:
            self._make_components()
            for manager, options in self.scene.manager_options.items():
                opens = self.context.network is not None or not needs_network(manager)
                if opens and options and manager not in self.context.stream_managers:
                    self.context.stream_managers[manager] = make_stream_manager(self.context, manager)
        self.observers[:0] = self.context.stream_managers.values()

    def _make_components(self) -> None:
        for table in (self.context.robots, self.context.external_robots, self.context.components):
            table.clear()
        self.context.failed.clear()
        self.loaded = load_components(self.context)
        connect(self.context, self.loaded)
        self.schedule()

    def schedule(self) -> None:
        """The components are other ones: work out anew which of them act in which tick."""
        self._ticker.schedule(self.loaded)

    # -- time ------------------------------------------------------------------------------

    def step(self, ticks: int = 1) -> None:
        """Let that many ticks pass, as fast as possible, whether the simulation is paused or not.

        Raises:
            UnstableError: the physics has no sensible answer any more.
            RuntimeError: the simulation is closed, or a tick is under way already.
            KeyboardInterrupt: Ctrl+C was pressed; of several ticks, the one in which that happened is complete.
        """
        self._check_open()
        if ticks < 0:
            raise ValueError(f"time does not go backwards: {ticks} ticks")
        tick, stepping, time = self._ticker.tick, self._stepping, self._time
        time.holds_back = ticks > 1
        with time:
            stepping.forced = True
            try:
                for _ in range(ticks):
                    tick()
                    stepping.count()
                    if self._failure is not None or time.interrupted:
                        break
            finally:
                stepping.forced = False
                if self._failure is not None or time.interrupted:
                    self._loop.go_on()
                if self.context.network is not None:
                    self.context.network.give_back()
        self._raise_failure()

    def run(self, duration: float | None = None, speed: float | None = None) -> None:
        """Let time pass until told to stop, in step with the wall clock.

        Args:
            duration: stop after that many simulated seconds; None to go on until `stop`.
            speed: simulated seconds per wall-clock second, ``math.inf`` for as fast as possible; None for what the
                scene or the options say.

        Raises:
            RuntimeError: the simulation is closed, or runs already.
            KeyboardInterrupt: Ctrl+C was pressed; the tick in which that happened is complete.
        """
        self._check_open()
        if duration is not None and not 0.0 <= duration < math.inf:
            raise ValueError(f"a duration is a number of seconds, not {duration!r}")
        if speed is not None:
            if not speed > 0.0:
                raise ValueError(f"a speed is greater than 0, not {speed!r}")
            self.pacer.set_speed(speed)
        ticks = math.inf if duration is None else round(duration * self.clock.frequency)
        if ticks:
            self._time.holds_back = True
            with self._time:
                self._loop.run(self.clock.tick + ticks)
            self._raise_failure()

    def stop(self) -> None:
        """End `run` after this tick; may be called from signal handlers."""
        self._loop.stop()

    def tick(self) -> bool:
        """One tick; False if the simulation is paused, or input has stopped time, so that no time passed."""
        self._check_open()
        self._time.holds_back = False
        with self._time:
            return self._ticker.tick()

    @property
    def paused(self) -> bool:
        """Whether no time passes in `run` but the ticks that somebody asked for."""
        return self._stepping.paused

    def pause(self) -> None:
        """Stop time in `run`; steps that a client waits for end as preempted."""
        self._stepping.paused = True
        self.cancel_steps()

    def resume(self) -> None:
        """Let time pass again in `run`."""
        self._stepping.paused = False
        self.pacer.restart()

    def request_steps(self, ticks: int = 1, ended: Callable[[tuple[str, Any]], object] = _nobody) -> Callable[[], None]:
        """Let `run` do that many ticks and no more, after those asked for before.

        Args:
            ended: called with the status when the data of the last tick is handed to the network.

        Returns:
            What cancels these ticks.
        """
        for manager in self.context.stream_managers.values():
            manager.drain()
        self._stepping.paused = True
        return self._stepping.add(ticks, ended)

    def cancel_steps(self) -> None:
        """Do no more of the ticks that were asked for."""
        self._stepping.end(status.PREEMPTED)

    # -- what comes in ---------------------------------------------------------------------

    @property
    def journal(self) -> Journal:
        """Everything that comes in from outside."""
        return self.context.journal

    def set_controls(self, keys: frozenset[str], axes: tuple[float, ...] = (), robot: str | None = None) -> None:
        """What a person does at the live view, from the next tick on; see `morse.core.context.Controls`."""
        controls = Controls(keys, axes, robot)
        if controls != self.context.controls:
            self.context.controls = controls
            self.journal.note(CONTROLS, "", (sorted(keys), list(axes), robot))

    # -- those who look on -----------------------------------------------------------------

    @property
    def observers(self) -> list[Observer]:
        """Who looks on: append an observer to have it told of every tick."""
        return self._ticker.observers

    @property
    def before_physics(self) -> list[Callable[[], object]]:
        """Called in every tick after the actuators and before the physics."""
        return self._ticker.before_physics

    def viewpoint_changed(self) -> None:
        """The camera of the scene was moved by a service."""
        for observer in self.observers:
            observer.viewpoint_changed()

    def show(self, height: int = 480) -> Any:
        """The live view in a frame; a notebook shows the frame where it is the value of a cell.

        Args:
            height: pixels.

        Raises:
            RuntimeError: the simulation was not loaded with ``view="web"``, or is closed.
        """
        self._check_open()
        show = getattr(self.view, "show", None)
        if show is None:
            raise RuntimeError("there is no page to show: load the simulation with view='web'")
        return show(height)

    def picture(self, width: int = 960, height: int = 600, **view: Any) -> Any:
        """The world as it is now, seen from where the live view begins.

        Args:
            width: pixels.
            height: pixels.
            view: ``location``, m, and ``rotation``, Euler angles in rad (``[0, 0, 0]`` looks straight down), of the
                camera; ``focal_length``, mm, of a sensor 32 mm wide.

        Returns:
            (height, width, 3) uint8, red, green and blue.

        Raises:
            ValueError: numbers that make no picture.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        from morse.rendering import photograph

        return photograph(self.world, width, height, **view)

    # -- state -----------------------------------------------------------------------------

    def seed(self) -> int:
        """The seed of all random numbers."""
        return self.context.seed

    def state_hash(self) -> str:
        """SHA-256 of all that determines the future; of two simulations with equal ones, the futures are equal."""
        self._check_open()
        return self._saving.save().hash()

    def save(self, path: str | os.PathLike[str] | None = None) -> State:
        """All that determines the future, to be restored later, here or in another simulation of the same scene.

        Args:
            path: also write it to this file.

        Raises:
            OSError: the file cannot be written.
        """
        self._check_open()
        state = self._saving.save()
        if path is not None:
            state.write(path)
        return state

    def restore(self, state: State | str | os.PathLike[str]) -> None:
        """Go on from a state that `save` gave, or from a file; services that are under way end as preempted.

        Raises:
            StateError: it is damaged, or belongs to another scene; nothing has changed then.
            OSError: the file cannot be read.
        """
        if not isinstance(state, State):
            state = State.read(state)
        self._check_open()
        self.journal.note(RESTORE, "", state)
        with acting(self.context):
            self._saving.restore(state, self._end_services)
            for obj in self.context.service_objects:
                if obj.get_state() is None:
                    obj.restart()
        for observer in self.observers:
            observer.rearranged()
        self._loop.restarted()

    def _end_services(self) -> None:
        """What clients wait for ends as preempted."""
        self.context.services.preempt(self.context.service_objects)
        self.cancel_steps()

    # -- coming and going ------------------------------------------------------------------

    def spawn(
        self,
        name: str,
        kind: str | Callable[[], Any],
        position: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> Any:
        """Let a robot or a thing come into the scene, between two ticks.

        Args:
            name: of the new one; no object of the scene has it.
            kind: the name of a robot of `morse.builder` or of a model such as ``props/crates``; or a function that
                returns a component of `morse.builder`: a robot with sensors and actuators, for example.
            position: metres in the world.
            rotation: roll, pitch, yaw, radians.

        Returns:
            The handle of a robot; None for a thing.

        Raises:
            MorseBuilderError: the name is taken, or there is no such kind.
            LoadError: a component cannot be made.
            ValueError: the engine refuses its shape.
        """
        self._check_open()
        check_newcomer(name, kind, position, rotation)
        self.journal.note(SPAWN, name, (kind, list(position), list(rotation)))
        self.population.spawn(name, kind, position, rotation)
        return self._all_handles().get(normalized(name))

    def delete(self, name: str) -> None:
        """Let a robot or a thing go, with all that is part of it.

        Raises:
            MorseBuilderError: there is none of that name, or it is part of another.
        """
        self._check_open()
        self.journal.note(DELETE, name, None)
        self.population.delete(name)

    def restart(self, seed: int | None = None) -> None:
        """Everything as after the launch, with that seed or the present one; not while components act.

        Raises:
            LoadError: a component cannot be made again; the simulation ends.
        """
        self._check_open()
        self.journal.note(RESET, "", seed)
        if seed is not None:
            self.context.seed = seed
        with acting(self.context):
            self._end_services()
            self.finalize_components()
            self.population.go_back()
            self.world.reset()
            self.clock.restart()
            for obj in self.context.service_objects:
                obj.restart()
            try:
                with self.scene.project:
                    self._make_components()
            except LoadError:
                self.failed = True
                self.stop()
                raise
        self.components_changed()
        for observer in self.observers:
            observer.restarted()
        self._loop.restarted()

    def start_anew(self) -> None:
        """What a person asks for (F11): an edited scene script is read again, where `morse run` follows files."""
        if self.reread is None or not self.reread():
            self.restart()

    # -- the end ---------------------------------------------------------------------------

    def finalize_components(self) -> None:
        """Tell the components and modifiers that the simulation is over."""
        loaded, self.loaded = self.loaded, Loaded()
        overlays = list(self.context.overlays.values())
        self.context.overlays.clear()
        for part in [*overlays, *loaded.actuators, *loaded.sensors, *loaded.robots, *loaded.modifier_objects]:
            self.finalize_one(part)

    @staticmethod
    def finalize_one(part: Any) -> None:
        """Tell a component, a modifier or an overlay that its time is over."""
        try:
            part.finalize()
        except Exception as error:
            logger.error("%s failed at the end: %s", part, describe(error))

    def finalize_services(self) -> None:
        """Stop the request managers."""
        self.context.services.finalize()

    def finalize_observers(self) -> None:
        """Tell those who look on that the simulation is over: streams are sent and closed, the view ends."""
        for observer in self.observers:
            try:
                observer.close()
            except Exception as error:
                logger.error("%s failed at the end: %s", type(observer).__name__, describe(error))

    def end(self) -> None:
        """Stop the network, after all else."""
        self.finished = True
        if self.context.network is not None:
            self.context.network.stop()
        forget(self.context)

    def close(self) -> None:
        """End the simulation, and release what it has taken; a closed one may be closed again."""
        if self.finished:
            return
        self._time.take_over(self.context.wake)
        self.end_recordings()
        with acting(self.context):
            self.finalize_components()
            self.finalize_services()
        self.finalize_observers()
        self.end()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _network(options: RunOptions) -> Any:
    if not options.sockets and options.view != "web":
        return None
    # not before it is needed: it brings asyncio
    from morse.core.network import Network

    return Network()
