"""One simulation: its tick, its loop, its end."""

from __future__ import annotations

import gc
import logging
import math
from time import perf_counter
from typing import TYPE_CHECKING, Any

from morse.core import context as _context
from morse.core import status
from morse.core.clock import Clock
from morse.core.context import Context
from morse.core.network import Network
from morse.core.realism import Realism
from morse.core.request_manager import MorseServices
from morse.core.sensor import Sensor
from morse.physics import UnstableError, World
from morse.physics.rays import RayBundle
from morse.services.camera_services import ViewpointServices
from morse.services.communication_services import CommunicationServices
from morse.services.lockstep_services import LockstepServices
from morse.services.supervision_services import Supervision
from morse.services.time_services import TimeServices
from morse.simulation.digest import state_hash
from morse.simulation.faults import describe
from morse.simulation.loader import Loaded, LoadError, add_request_manager, load_components, make_stream_manager
from morse.simulation.pacing import Pacer
from morse.simulation.profile import Profile
from morse.simulation.schedule import Schedule
from morse.simulation.stepping import Stepping

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.abstractobject import AbstractObject
    from morse.core.object import Object
    from morse.scene import Scene
    from morse.simulation.live_view import LiveView
    from morse.simulation.options import RunOptions

logger = logging.getLogger("morse." + __name__)

#: ticks that are measured to find out what a slow simulation spends its time on
_DIAGNOSIS = 60
SOCKET_REQUESTS = "morse.middleware.socket_request_manager.SocketRequestManager"


def _nobody(_outcome: tuple[str, Any]) -> None:
    """Nobody waits for the end of the steps."""


class Simulation:
    """A loaded scene that can be run.

    Attributes:
        context: what components see.
        pacer: keeps it in step with the wall clock.
        failed: it has to end because something cannot go on.
    """

    def __init__(self, scene: Scene, options: RunOptions) -> None:
        settings = scene.settings
        self.options = options
        self.scene = scene
        self.duration = options.duration
        seed = settings.seed if options.seed is None else options.seed
        speed = settings.time_scale if options.speed is None else options.speed
        self.context = Context(
            scene=scene,
            clock=Clock(settings.frequency, settings.time_strategy, absolute=not settings.relative_time),
            world=World(scene),
            services=MorseServices(),
            network=Network(),
            seed=seed,
            host=options.host,
        )
        self.world: World = self.context.world
        self.clock = self.context.clock
        self.pacer = Pacer(self.clock.period, speed, before_sleep=self.context.network.give_back)
        self.context.stopping = lambda: self._stop
        self._stepping = Stepping()
        self.view: LiveView | None = None
        self.profile: Profile | None = Profile(trace=True) if options.profile else None
        #: measures the sensors that the script wants to be profiled
        self.sensor_profile = Profile() if any(d.profile for d in scene.components) else None
        self._diagnosis: Profile | None = None
        self._slow = False
        self._stop = False
        self.failed = False
        self.finished = False
        self.loaded = Loaded()
        _context.set_current(self.context)
        self._add_services()

    # -- set-up ----------------------------------------------------------------------------

    def _add_services(self) -> None:
        """Start the request managers that offer the services of the simulation itself."""
        add_request_manager(self.context, SOCKET_REQUESTS)
        for manager in self.scene.simulation_managers:
            add_request_manager(self.context, manager)
        self._offer(Supervision(self.context, self.stop))
        self._offer(LockstepServices(self))
        self._offer(ViewpointServices(self.scene.settings.view, self._viewpoint_changed))
        self._offer(TimeServices(self.clock, self.pacer.set_speed))
        self._offer(CommunicationServices(self.context))

    def _offer(self, obj: AbstractObject) -> None:
        for manager in [SOCKET_REQUESTS, *self.scene.simulation_managers]:
            self.context.services.register_request_manager_mapping(obj.name(), manager)
        self.context.services.register_object(obj.name(), obj)
        self.context.service_objects.setdefault(obj.name(), obj)

    def load(self) -> None:
        """Make the components and connect them."""
        self._make_components()
        for manager, options in self.scene.manager_options.items():
            if options and manager not in self.context.stream_managers:
                self.context.stream_managers[manager] = make_stream_manager(self.context, manager)
        self._managers = list(self.context.stream_managers.values())
        # what exists now stays to the end: the collector need not look through it again and again
        gc.collect()
        gc.freeze()

    def _make_components(self) -> None:
        self.loaded = load_components(self.context)
        frequency = self.clock.frequency
        self._robots = self.loaded.robots
        self._actuators: Schedule[Object] = Schedule(self.loaded.actuators, frequency)
        self._sensors: Schedule[Object] = Schedule(self.loaded.sensors, frequency, _phase)
        sensors = [sensor for sensor in self.loaded.sensors if isinstance(sensor, Sensor)]
        with_rays = [sensor for sensor in sensors if isinstance(sensor.rays, RayBundle)]
        self._with_rays = Schedule(with_rays, frequency, _phase)
        self._delayed = [s.realism for s in sensors if isinstance(s.realism, Realism) and s.realism.delay]

    # -- running ---------------------------------------------------------------------------

    def stop(self) -> None:
        """End the run after this tick; may be called from signal handlers."""
        self._stop = True
        self.pacer.stop()

    @property
    def paused(self) -> bool:
        """Whether no time passes but the ticks that somebody asked for."""
        return self._stepping.paused

    def pause(self) -> None:
        """Stop time; steps that somebody waits for end as preempted."""
        self._stepping.paused = True
        self.cancel_steps()

    def resume(self) -> None:
        """Let time pass again."""
        self._stepping.paused = False
        self.pacer.restart()

    def step(self, ticks: int = 1, ended: Callable[[tuple[str, Any]], object] = _nobody) -> None:
        """Let that many ticks pass and no more, after those asked for before.

        Args:
            ended: called with the status when their data is handed to the network.
        """
        self._stepping.paused = True
        self._stepping.add(ticks, ended)

    def cancel_steps(self) -> None:
        """Do no more of the ticks that were asked for."""
        self._stepping.end(status.PREEMPTED)

    def seed(self) -> int:
        """The seed of all random numbers."""
        return self.context.seed

    def state_hash(self) -> str:
        """See `morse.simulation.digest.state_hash`."""
        return state_hash(self.context)

    def run(self) -> None:
        """Tick until told to stop, or until the duration asked for has passed."""
        self.pacer.restart()
        clock, pacer, network = self.clock, self.pacer, self.context.network
        last = math.inf if self.duration is None else round(self.duration * clock.frequency)
        try:
            while not self._stop:
                if self._stepping.halted:
                    self._wait_paused()
                    continue
                if not self.tick():
                    continue
                self._stepping.count()
                if clock.tick >= last:
                    break
                network.tend()
                if not self.paused:
                    pacer.wait()
                    if pacer.lost:
                        self._diagnose()
        except UnstableError as error:
            self._stepping.end(status.FAILED, str(error))
            raise
        finally:
            network.give_back()

    def _wait_paused(self) -> None:
        """No time passes: carry out what clients and pages ask for, and wait for more."""
        if self.view is not None:
            self.view.before_tick()
        self.context.services.process()
        if self.view is not None:
            self.view.after_tick()
        if self._stepping.halted and not self._stop:
            self.context.wait(self.clock.period)
            self.pacer.restart()

    def _diagnose(self) -> None:
        """The simulation is too slow: find out why, and say so from time to time."""
        measured = self.profile or self._diagnosis
        if measured is None:
            self._diagnosis = Profile()
            return
        if measured.ticks < _DIAGNOSIS:
            return
        lost = self.pacer.report_due()
        if not lost:
            return
        name, cost = measured.costliest()
        self._diagnosis = None
        logger.warning(
            "the simulation cannot keep up: %.1f s lost, running at %.2f times real time (asked for %.2f); "
            "most time goes to %s: %.1f ms a tick of %.1f ms",
            lost,
            self.pacer.real_time_factor,
            self.pacer.speed,
            name,
            cost * 1e3,
            self.clock.period / self.pacer.speed * 1e3,
        )
        self._slow = True
        if self.view is not None:
            self.view.report_pace(lost, name, cost * 1e3)

    def _recovered(self) -> None:
        self._slow = False
        if self.view is not None:
            self.view.report_pace(0.0)

    def tick(self) -> bool:
        """One tick: input, services, actuators, physics, sensors, output.

        Returns:
            False if the input has stopped time, so that none passed.
        """
        context, clock = self.context, self.clock
        profile = self.profile or self._diagnosis
        if profile is not None:
            profile.begin()
        if self.view is not None:
            self.view.before_tick()
        if profile is not None:
            profile.mark("view input")
        for manager in self._managers:
            manager.action()
        clock.observe()
        if profile is not None:
            profile.mark("streams in")
        for obj in context.service_objects.values():
            obj.action()
        context.services.process()
        if profile is not None:
            profile.mark("services")
        if self._stepping.halted:
            # paused, or started anew while paused: what somebody reads or does next is to find that very state
            return False
        due = clock.tick
        self._act(self._robots, profile)
        self._act(self._actuators.due(due), profile)
        if profile is not None:
            profile.mark("actuators")
        self.world.step()
        clock.advance()
        if profile is not None:
            profile.mark("physics")
        for robot in self._robots:
            robot.update_pose()
        self._cast_rays(due)
        if profile is not None:
            profile.mark("rays")
        self._act(self._sensors.due(due), profile)
        for realism in self._delayed:
            realism.release()
        if profile is not None:
            profile.mark("sensors")
        for manager in self._managers:
            manager.flush()
        if profile is not None:
            profile.mark("streams out")
        if self.view is not None:
            self.view.after_tick()
        if profile is not None:
            profile.mark("view output")
        return True

    def _cast_rays(self, tick: int) -> None:
        """Cast the rays of all sensors that are due in one go; that costs little more than one of them alone."""
        bundles = [sensor.rays for sensor in self._with_rays.due(tick) if sensor.active]
        if bundles:
            self.world.rays.cast(bundles)

    def _act(self, components: Sequence[Object], profile: Profile | None) -> None:
        sensor_profile = self.sensor_profile
        unmeasured = profile is None and sensor_profile is None
        for component in components:
            try:
                if unmeasured:
                    component.action()
                else:
                    begin = perf_counter()
                    component.action()
                    end = perf_counter()
                    for one in (profile, sensor_profile):
                        if one is not None:
                            one.component(component.name(), begin, end)
            except Exception as error:
                component.active = False
                logger.error("[ERROR][MORSE] %s failed and is deactivated: %s", component.name(), describe(error))

    def restart(self, seed: int | None = None) -> None:
        """Everything as after the launch, with that seed or the present one; not while components act.

        Raises:
            LoadError: a component cannot be made again; the simulation ends.
        """
        if seed is not None:
            self.context.seed = seed
        self.context.services.preempt(self.context.service_objects.values())
        self.cancel_steps()
        self.finalize_components()
        self.world.reset()
        self.clock.restart()
        for obj in self.context.service_objects.values():
            obj.restart()
        try:
            self._make_components()
        except LoadError:
            self.failed = True
            self.stop()
            raise
        if self.view is not None:
            self.view.restarted()
        self.pacer.restart()

    def _viewpoint_changed(self) -> None:
        if self.view is not None:
            self.view.viewpoint_changed()

    # -- the end ---------------------------------------------------------------------------

    def finalize_components(self) -> None:
        """Tell the components and modifiers that it is over."""
        loaded, self.loaded = self.loaded, Loaded()
        overlays = list(self.context.overlays.values())
        self.context.overlays.clear()
        for part in [*overlays, *loaded.actuators, *loaded.sensors, *loaded.robots, *loaded.modifier_objects]:
            try:
                part.finalize()
            except Exception as error:
                logger.error("%s failed at the end: %s", part, describe(error))

    def finalize_services(self) -> None:
        """Stop the request managers."""
        self.context.services.finalize()

    def finalize_streams(self) -> None:
        """Stop the stream managers."""
        for manager in self.context.stream_managers.values():
            manager.finalize()

    def close(self) -> None:
        """Stop the view and the network."""
        if self.view is not None:
            self.view.close()
        self.context.network.stop()
        _context.set_current(None)

    def shut_down(self) -> None:
        """All of the end, without saying so."""
        self.finalize_components()
        self.finalize_services()
        self.finalize_streams()
        self.close()


def _phase(component: Object) -> float:
    realism = getattr(component, "realism", None)
    return realism.phase if isinstance(realism, Realism) else 0.0
