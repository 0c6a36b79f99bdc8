"""One simulation: its tick, its loop, its end."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING

from morse.core import context as _context
from morse.core.clock import Clock
from morse.core.context import Context
from morse.core.network import Network
from morse.core.request_manager import MorseServices
from morse.physics import World
from morse.services.camera_services import ViewpointServices
from morse.services.communication_services import CommunicationServices
from morse.services.supervision_services import Supervision
from morse.services.time_services import TimeServices
from morse.simulation.faults import describe
from morse.simulation.loader import add_request_manager, load_components, make_stream_manager
from morse.simulation.pacing import Pacer
from morse.simulation.schedule import Schedule

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.abstractobject import AbstractObject
    from morse.core.object import Object
    from morse.scene import Scene
    from morse.simulation.options import RunOptions
    from morse.simulation.viewing import View

logger = logging.getLogger("morse." + __name__)

SOCKET_REQUESTS = "morse.middleware.socket_request_manager.SocketRequestManager"


class Simulation:
    """A loaded scene that can be run.

    Attributes:
        context: what components see.
        pacer: keeps it in step with the wall clock.
        paused: no time passes; services are still answered.
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
        self.pacer = Pacer(self.clock.period, speed)
        self.paused = False
        self.view: View | None = None
        self._steps = 0
        self._stop = False
        self._reset_asked = False
        self.finished = False
        _context.set_current(self.context)
        self._add_services()

    # -- set-up ----------------------------------------------------------------------------

    def _add_services(self) -> None:
        """Start the request managers that offer the services of the simulation itself."""
        add_request_manager(self.context, SOCKET_REQUESTS)
        for manager in self.scene.simulation_managers:
            add_request_manager(self.context, manager)
        self._offer(Supervision(self.context, self.stop, self.ask_reset))
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
        self.loaded = load_components(self.context)
        for manager, options in self.scene.manager_options.items():
            if options and manager not in self.context.stream_managers:
                self.context.stream_managers[manager] = make_stream_manager(self.context, manager)
        frequency = self.clock.frequency
        self._robots = self.loaded.robots
        self._actuators: Schedule[Object] = Schedule(self.loaded.actuators, frequency)
        self._sensors: Schedule[Object] = Schedule(self.loaded.sensors, frequency)
        self._managers = list(self.context.stream_managers.values())

    # -- running ---------------------------------------------------------------------------

    def stop(self) -> None:
        """End the run after this tick; may be called from signal handlers."""
        self._stop = True
        self.pacer.interrupt()

    def ask_reset(self) -> None:
        """Put everything back to the start, after this tick."""
        self._reset_asked = True

    def step(self, ticks: int = 1) -> None:
        """While paused: let that many ticks pass."""
        self._steps += ticks

    def run(self) -> None:
        """Tick until told to stop, or until the duration asked for has passed."""
        self.pacer.restart()
        clock, pacer = self.clock, self.pacer
        last = math.inf if self.duration is None else round(self.duration * clock.frequency)
        while not self._stop:
            if self.paused and not self._steps:
                self._wait_paused()
                continue
            self.tick()
            if self._steps:
                self._steps -= 1
            if clock.tick >= last:
                break
            pacer.wait()
            lost = pacer.report_due()
            if lost:
                logger.warning(
                    "the simulation is too slow for the wall clock: %.1f s lost, now %.2f times real time of %.2f asked for",
                    lost,
                    pacer.real_time_factor,
                    pacer.speed,
                )

    def _wait_paused(self) -> None:
        if self.view is not None:
            self.view.before_tick()
        self.context.services.process()
        if self._reset_asked:
            self.reset()
        if self.view is not None:
            self.view.after_tick()
        self.pacer.idle(self.clock.period)

    def tick(self) -> None:
        """One tick: input, services, actuators, physics, sensors, output."""
        context, clock = self.context, self.clock
        if self.view is not None:
            self.view.before_tick()
        for manager in self._managers:
            manager.action()
        clock.observe()
        for obj in context.service_objects.values():
            obj.action()
        context.services.process()
        due = clock.tick
        self._act(self._robots)
        self._act(self._actuators.due(due))
        self.world.step()
        clock.advance()
        self._act(self._robots)
        self._act(self._sensors.due(due))
        for manager in self._managers:
            manager.flush()
        if self._reset_asked:
            self.reset()
        if self.view is not None:
            self.view.after_tick()

    def _act(self, components: Sequence[Object]) -> None:
        for component in components:
            try:
                component.action()
            except Exception as error:
                component.active = False
                logger.error("%s failed and is deactivated: %s", component.name(), describe(error))

    def reset(self) -> None:
        """Every object back to where it was at the start, at rest."""
        self._reset_asked = False
        self.world.reset()

    def _viewpoint_changed(self) -> None:
        if self.view is not None:
            self.view.viewpoint_changed()

    # -- the end ---------------------------------------------------------------------------

    def finalize_components(self) -> None:
        """Tell the components and modifiers that it is over."""
        if not hasattr(self, "loaded"):
            return
        parts = [*self.loaded.actuators, *self.loaded.sensors, *self.loaded.robots, *self.loaded.modifier_objects]
        for part in parts:
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
        """Stop the network."""
        self.context.network.stop()
        _context.set_current(None)
