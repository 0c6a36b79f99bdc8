"""A simulation, as an object."""

from __future__ import annotations

import logging
import math
import os
from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, NoReturn, cast

from morse.core.clock import Clock
from morse.core.context import Context, Controls, acting, forget
from morse.core.hidden_methods import uncover
from morse.core.journal import CONTROLS, DELETE, RESET, RESTORE, SPAWN
from morse.core.request_manager import MorseServices
from morse.core.sensor import Sensor
from morse.middleware.registry import needs_network
from morse.physics import World
from morse.scene.image_workers import image_workers
from morse.simulation.ending import Ending, Finalizing
from morse.simulation.handles.component_handles import normalized
from morse.simulation.handles.handles import Handles
from morse.simulation.handles.world_changes import SimulationPictures, sensor_names
from morse.simulation.loader import Loaded, LoadError, connect, load_components, make_stream_manager
from morse.simulation.offering import offer_services
from morse.simulation.population import Population
from morse.simulation.recordings.input_recording import InputRecorder
from morse.simulation.recordings.recorders import start_recording
from morse.simulation.recordings.replaying import Replay
from morse.simulation.states.saving import LaunchStates, Saving
from morse.simulation.states.state import State
from morse.simulation.ticks.loop import Loop
from morse.simulation.ticks.profile import Profile
from morse.simulation.ticks.stepping import Ownership, Paused, Stepping
from morse.simulation.ticks.ticking import Ticker
from morse.simulation.watching.edits import Edits

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType

    from morse.core.guard import Failure
    from morse.core.journal import Journal
    from morse.core.observer import Observer
    from morse.physics.model.compile import Compiled
    from morse.recording.recorder import Recorder
    from morse.scene import Scene
    from morse.simulation.handles.world_changes import LiveView, NamedPictures
    from morse.simulation.options import RunOptions
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.recordings.recorders import FlightRecorder


logger = logging.getLogger(__name__)


class Simulation(Finalizing, Handles, Paused, SimulationPictures):
    """A loaded scene that can be run; it is created by `morse.load`.

    Robots are attributes, and their components are attributes of the robots, with the interface of `pymorse.Morse`: see
    `morse.simulation.handles.handles`. Simulated time advances only in `step` and `run`.

    Attributes:
        context: the interface of the simulation for components.
        observers: objects that are notified before and after each tick, in order.
        view: the live view, which is one of the observers, or None.
        edits: files that were saved while it runs.
        delays_interrupts: whether Ctrl+C takes effect after a complete tick; somebody else does that for a batch.
        failed: whether the simulation has to end because a part of it cannot continue.
        recorders: the active recordings in files.
        flight_recorder: keeps the last seconds before a failure, or None.

    Args:
        compiled: see `morse.physics.World`.
    """

    def __init__(self, scene: Scene, options: RunOptions, compiled: Compiled | None = None) -> None:
        settings = scene.settings
        self.options = options
        self.scene = scene
        self.world = world = World(scene, compiled)
        self.context = Context(
            scene=scene,
            clock=Clock(settings.frequency, settings.time_strategy, start=settings.origin),
            world=world,
            services=MorseServices(),
            network=_network(options),
            seed=settings.seed if options.seed is None else options.seed,
            host=options.host,
            file_label=options.file_label,
            strict=options.strict,
            image_workers=image_workers(settings.cameras_on if options.cameras_on is None else options.cameras_on),
        )
        self.clock = self.context.clock
        self._stepping = Stepping(self.context.guard)
        self._ticker = Ticker(self.context, self._stepping)
        speed = settings.time_scale if options.speed is None else options.speed
        self._loop = Loop(self.context, self._ticker, self._stepping, speed)
        self.pacer = self._loop.pacer
        self.context.stopping = lambda: self._loop.stopping
        self.context.paused = lambda: self._stepping.paused
        self.context.guard.remarks = uncover
        self.view: LiveView | None = None
        #: callback that loads the edited scene instead of this one; it returns False if nothing has changed
        self.reread: Callable[[], bool] | None = None
        self.edits = Edits()
        self.profile: Profile | None = None
        #: profile of the sensors for which the script requests a profile
        self.sensor_profile = Profile() if any(d.profile for d in scene.components) else None
        self._set_up_profiles()
        self.recorders: list[Recorder] = []
        self.flight_recorder: FlightRecorder | None = None
        self.failed = self.finished = False
        self.delays_interrupts = True
        self._time = Ownership(self.stop)
        self.ending = Ending()
        self.ending.overdue = self._overdue
        self.loaded = Loaded()
        super().__init__()
        if options.on_failure == "raise":
            self.context.guard.raises = self.part_failed
        self.population = Population(self)
        self.pictures: NamedPictures
        self._saving = Saving(self)
        self._launch = LaunchStates(self)
        with acting(self.context), scene.project:
            offer_services(self)

    def _set_up_profiles(self) -> None:
        if self.options.profile:
            self.profile = Profile(trace=True)
            self._ticker.profiles.append(self.profile)
        self._ticker.component_profiles += [p for p in (self.profile, self.sensor_profile) if p is not None]

    def load(self) -> None:
        """Create the components and connect them.

        Raises:
            LoadError: the message contains the component and the line of the script that created it.
        """
        try:
            with acting(self.context), self.scene.project:
                self._make_components()
                for manager, options in self.scene.manager_options.items():
                    opens = self.context.network is not None or not needs_network(manager)
                    if opens and options and manager not in self.context.stream_managers:
                        self.context.stream_managers[manager] = make_stream_manager(self.context, manager)
        finally:
            # also if a stream is refused: the streams that are open are then closed
            self.observers[:0] = cast("Iterable[Observer]", self.context.stream_managers.values())

    def _make_components(self) -> None:
        for table in (self.context.robots, self.context.external_robots, self.context.components):
            table.clear()
        self.context.failed.clear()
        self._launch.begin()
        self.loaded = load_components(self.context)
        connect(self.context, self.loaded)
        self.schedule()
        self._launch.take()

    def schedule(self) -> None:
        """Update the schedule after the components have changed."""
        self._ticker.schedule(self.loaded)

    def measure_always(self, name: str) -> None:
        """Let a sensor measure at its rate, whoever reads it; sensors of model files may do so only for a reader."""
        component = self.context.components.get(name)
        if not isinstance(component, Sensor) or not component.on_demand:
            return
        for declaration in self.scene.components:
            if declaration.name == name:
                # also after a restart
                declaration.node.properties["on_demand"] = False
        component.on_demand = False
        self.schedule()

    def __repr__(self) -> str:
        name = PurePath(self.options.script).name or "a scene"
        robots = ", ".join(self.context.robots) or "none"
        state = "closed" if self.finished else f"tick {self.ticks}, {self.clock.time:g} s"
        return f"<Simulation of {name}, seed {self.context.seed}, {state}; robots: {robots}>"

    # -- time ------------------------------------------------------------------------------

    def step(self, ticks: int = 1, *, measure: bool | Sequence[str] = False) -> None:
        """Run ``ticks`` ticks as fast as possible, even if the simulation is paused.

        Sensors measure at their own rates: after 6 ticks at 60 Hz the data of a sensor of 10 Hz may be 5 ticks old.

        Args:
            measure: whether all sensors measure at the end of the last tick, in addition; or the full names of those
                that do.

        Raises:
            ValueError, TypeError: ``ticks`` is not an integer of at least 0.
            KeyError: there is no such sensor.
            UnstableError: the physics has become unstable.
            BaseException: the error of a part that failed, if the simulation was loaded with ``on_failure="raise"``;
                the tick was completed, and a note names the part and the tick.
            RuntimeError: the simulation is closed, or a tick is already running.
            KeyboardInterrupt: Ctrl+C was pressed; the present tick was completed first.
        """
        if self.finished:
            self._check_open()
        if type(ticks) is not int or ticks < 0 or not isinstance(measure, bool):
            self.check_step(ticks, measure)
        for contacts in self._contacts.values():
            contacts.begin()
        advance, stepping, time = self._ticker.advance, self._stepping, self._time
        time.holds_back = ticks > 1 and self.delays_interrupts
        with time:
            stepping.forced = True
            try:
                remaining = ticks
                while remaining:
                    remaining -= advance(remaining, measure is True)
                    if not stepping.is_idle:
                        stepping.count()
                    if self._failure is not None or time.interrupted:
                        break
                else:
                    if measure:
                        self._measure(measure, again=not ticks)
            finally:
                stepping.forced = False
                if self._failure is not None or time.interrupted:
                    self._loop.go_on()
                if self.context.network is not None:
                    self.context.network.give_back()
        if self._failure is not None:
            self._raise_failure()

    def check_step(self, ticks: int, measure: Sequence[str] | bool) -> None:
        """Raise the error that `Simulation.step` would raise for these arguments."""
        if isinstance(ticks, bool) or not hasattr(ticks, "__index__"):
            raise TypeError(f"the number of ticks is an integer, not {ticks!r:.80}")
        if ticks < 0:
            raise ValueError(f"time does not go backwards: {ticks} ticks")
        if not isinstance(measure, bool):
            self._check_sensors(sensor_names(measure))

    def run(self, duration: float | None = None, speed: float | None = None) -> None:
        """Run in step with the wall clock until `stop` is called.

        Args:
            duration: stop after that many simulated seconds; None to run until `stop`.
            speed: simulated seconds per wall-clock second, ``math.inf`` for as fast as possible; None for the value of
                the scene or the options.

        Raises:
            RuntimeError: the simulation is closed, or is already running.
            KeyboardInterrupt: Ctrl+C was pressed; the present tick was completed first.
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
        """Run one tick; return False if the simulation is paused, or was paused by input of this tick."""
        if self.finished:
            self._check_open()
        self._time.holds_back = False
        with self._time:
            has_passed = self._ticker.tick()
        if self._failure is not None:
            self._loop.go_on()
            self._raise_failure()
        return has_passed

    @property
    def failures(self) -> tuple[Failure, ...]:
        """What has failed since the scene was loaded, in order: see `morse.core.guard.Failure`.

        `restart`, `restore` and `close` keep them. An empty tuple says that no part was switched off by an error, and
        that no robot has left the world.
        """
        return tuple(self.context.guard.failures)

    # -- input -----------------------------------------------------------------------------

    @property
    def journal(self) -> Journal:
        """All input from outside."""
        return self.context.journal

    @property
    def is_new(self) -> bool:
        """Whether nothing has happened since the launch or a restart: its state is that of a launch with its seed."""
        return not self.clock.tick and self.journal.is_blank and self.context.controls == Controls()

    def set_controls(self, keys: frozenset[str], axes: tuple[float, ...] = (), robot: str | None = None) -> None:
        """Set keyboard and gamepad input from the next tick on; see `morse.core.context.Controls`."""
        if (keys, axes, robot) != self.context.controls:
            self.context.controls = Controls(keys, axes, robot)
            self.journal.note(CONTROLS, "", (sorted(keys), list(axes), robot))

    # -- observers -------------------------------------------------------------------------

    @property
    def observers(self) -> list[Observer]:
        """The observers; append an observer to notify it of every tick."""
        return self._ticker.observers

    @property
    def before_physics(self) -> list[Callable[[], object]]:
        """Callbacks that are called in every tick after the actuators and before the physics."""
        return self._ticker.before_physics

    @property
    def reviews(self) -> list[Callable[[int, bool], int]]:
        """Functions that look at the components from time to time; see `morse.simulation.ticks.ticking.Ticker`."""
        return self._ticker.reviews

    def viewpoint_changed(self) -> None:
        """Called when a service moved the camera of the scene."""
        self.context.guard.tell(self.observers, lambda observer: observer.viewpoint_changed())

    # -- state -----------------------------------------------------------------------------

    def seed(self) -> int:
        """The seed of all random numbers."""
        return self.context.seed

    def state_hash(self) -> str:
        """Return the SHA-256 of the state; simulations with equal hashes have the same future."""
        self._check_open()
        return self._saving.save().hash()

    def save(self, path: str | os.PathLike[str] | None = None) -> State:
        """Return the state, which can be restored later in this or another simulation of the same scene.

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

    def silent_state(self) -> State:
        """The complete state, as from `save`, without warnings about values that cannot be saved."""
        return self._saving.save(tell=False)

    def restore(self, state: State | str | os.PathLike[str]) -> None:
        """Restore a state that `save` returned, or a file; running services end as preempted.

        Raises:
            StateError: it is damaged, or belongs to another scene; nothing has changed then.
            TypeError: it is neither a state nor a path.
            OSError: the file cannot be read.
        """
        if not isinstance(state, State):
            if not isinstance(state, (str, os.PathLike)):
                raise TypeError(f"a state is what save() returns, or the path of a file, not {state!r:.80}")
            state = State.read(state)
        self._check_open()
        with self.journal.input(RESTORE, "", state), acting(self.context):
            # rows have data and poses of the state before
            self._ticker.separate()
            try:
                self._saving.restore(state, self._end_services)
            finally:
                self._ticker.gather()
            for obj in self.context.service_objects:
                if obj.get_state() is None:
                    obj.restart()
        self.context.guard.tell(self.observers, lambda observer: observer.rearranged())
        self._loop.restarted()

    def arrange(self, state: State, *, described: bool) -> None:
        """Restore who is there and where, to show a recorded run; see `Saving.arrange`."""
        self._check_open()
        with acting(self.context):
            self._saving.arrange(state, described=described)
        self.context.guard.tell(self.observers, lambda observer: observer.rearranged())

    def _end_services(self) -> None:
        """End running services as preempted."""
        self.context.services.preempt(self.context.service_objects)
        self.cancel_steps()

    # -- recordings ------------------------------------------------------------------------

    def record(self, path: str | os.PathLike[str], sensors: Sequence[str] | None = None) -> Recorder:
        """Record the run in an MCAP file: sensors, frames, log, and all inputs.

        The recording continues until `Recorder.stop`, the end of a ``with`` block, or the end of the simulation.

        Args:
            path: path of the file, which must not exist.
            sensors: full names of the recorded sensors; None for all, empty for only inputs and the log.

        Raises:
            RecordingError: the file exists or cannot be written, or there is no such sensor.
        """
        self._check_open()
        with acting(self.context):
            return start_recording(self, path, sensors)

    def end_recordings(self) -> None:
        """Complete the files of all recordings; errors are logged."""
        for recorder in list(self.recorders):
            recorder.close()

    def record_inputs(self) -> InputRecorder:
        """Record all inputs from now on; see `replay`."""
        return InputRecorder(self)

    def replay(
        self,
        recording: InputRecording,
        each_tick: Callable[[], object] | None = None,
        *,
        results: bool = True,
    ) -> None:
        """Replay a recording from its beginning to its end, bit for bit.

        Args:
            recording: recording of a simulation of the same scene.
            each_tick: callback, called after every tick.
            results: whether the results of services have to be the same.

        Raises:
            StateError: the recording belongs to another scene, or an input does not fit the run: it has another
                outcome, for example.
        """
        self._check_open()
        Replay(self, recording, results=results).run(each_tick)

    # -- spawning and deletion -------------------------------------------------------------

    def spawn(
        self,
        name: str,
        kind: str | Callable[[], object],
        position: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] = (0.0, 0.0, 0.0),
        *,
        by_client: bool = False,
    ) -> object:
        """Spawn a robot or an object between two ticks.

        Args:
            name: name of the new object: letters (a to z), digits and ``_``; it must not exist in the scene, nor be
                reserved, such as ``simulation``.
            kind: the name of a robot of `morse.builder` or of a model such as ``props/crates``; or a function that
                returns a component of `morse.builder`: a robot with sensors and actuators, for example.
            position: x, y, z in the world, m.
            rotation: roll, pitch, yaw, rad.
            by_client: whether a client asks for it, for whom there are budgets.

        Returns:
            The handle of a robot; None for another object.

        Raises:
            MorseBuilderError: the name is invalid or already exists, or there is no such kind, or it is beyond a
                budget.
            LoadError: a component cannot be created.
            ValueError: the engine refuses the shape of the object.
        """
        self._check_open()
        self.population.check(name, kind, position, rotation)
        with self.journal.input(SPAWN, name, (kind, list(position), list(rotation))):
            self.population.spawn(name, kind, position, rotation, by_client=by_client)
        return self._all_handles().get(normalized(name))

    def delete(self, name: str) -> None:
        """Delete a robot or an object with all its parts.

        Raises:
            MorseBuilderError: there is no object of that name, or it is a part of another object.
        """
        self._check_open()
        with self.journal.input(DELETE, name, None):
            self.population.delete(name)

    def restart(self, seed: int | None = None) -> None:
        """Restart the simulation as after the launch, with ``seed`` or the present seed; not while components act.

        Raises:
            LoadError: a component cannot be recreated; the simulation ends.
        """
        self._check_open()
        with self.journal.input(RESET, "", seed), acting(self.context):
            if seed is not None:
                self.context.seed = seed
            self.context.robot_seeds.clear()
            self._end_services()
            renews = not self.population.has_changed and self._launch.may_renew()
            if not renews:
                self.finalize_components()
            self.population.go_back()
            self.world.reset(motors=renews)
            self.clock.restart()
            for obj in self.context.service_objects:
                obj.restart()
            if renews:
                self._launch.renew()
                self.loaded = replace(self.loaded)  # what is known of the components holds no more
                self._ticker.begin_anew()
                self.context.failed.clear()
            else:
                self._create_again()
        self.components_changed()
        self.context.guard.tell(self.observers, lambda observer: observer.restarted())
        self._loop.restarted()

    def _create_again(self) -> None:
        try:
            with self.scene.project:
                self._make_components()
        except LoadError:
            self.failed = True
            self.stop()
            raise

    def start_anew(self) -> None:
        """Restart on request of the user (F11); `morse run` then reads an edited scene script again."""
        if self.reread is None or not self.reread():
            self.restart()

    # -- the end ---------------------------------------------------------------------------

    def end(self) -> None:
        """Stop the network as the last step."""
        self.finished = True
        if self.context.network is not None:
            self.context.network.stop()
        self.context.close_servers()
        forget(self.context)

    def close(self) -> None:
        """End the simulation and release its resources; closing it again has no effect.

        Raises:
            BaseException: the error of a part that has failed while it ended, if the simulation was loaded with
                ``on_failure="raise"``; everything is released then.
        """
        if self.finished:
            return
        self._time.take_over(self.context.wake)
        self.end_recordings()
        with acting(self.context):
            self.finalize_components()
            self.finalize_services()
        self.finalize_observers()
        self.end()
        self._raise_failure()

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "a running simulation cannot be copied or pickled: send its scene (a path, a function or a "
            "morse.scene.Scene) or its state, simulation.save()"
        )

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None:  # it must not be replaced by the error of a part that ends
            self.context.guard.raises = self._failure = None
        self.close()


def _network(options: RunOptions) -> Any:
    if not options.sockets and options.view != "web":
        return None
    # imported on demand, because it imports asyncio
    from morse.core.clients.network import Network

    return Network()
