"""Simulated time, physics, middlewares and nodes of a scene."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder.abstractcomponent import HIGHEST_FREQUENCY
from morse.builder.assembly.description import EnvironmentDescription
from morse.builder.compatibility import call_of_today
from morse.builder.components.interfaces import Interfaces
from morse.builder.errors import checks
from morse.builder.errors.declared import manager_options
from morse.builder.names import frames
from morse.builder.workspace import notice
from morse.core.clock import SLOWEST
from morse.core.exceptions import MorseMultinodeError
from morse.core.reports import log
from morse.middleware import registry
from morse.scene import TimeStrategies
from morse.scene.image_workers import image_workers

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


logger = logging.getLogger(__name__)

_LOG_LEVELS = ("DEBUG", "INFO", "ENDSECTION", "SECTION", "WARNING", "ERROR", "CRITICAL")
_VSYNC = ("ON", "OFF", "ADAPTIVE")
_PROTOCOLS = ("socket", "hla")


class TimeMethods(EnvironmentDescription):
    """The part of `Environment` for time and physics."""

    def set_gravity(self, gravity: float = 9.81) -> None:
        """Set the gravity along -Z, m/s^2; 0 for weightlessness."""
        self.settings.gravity = checks.number(gravity, "env.set_gravity(gravity)", minimum=0.0)
        self._gravity_given = True

    def set_physics_step_sub(self, step_sub: int = 2) -> None:
        """Set the number of physics steps per tick.

        Without it, steps are at most 1/240 s, or as long as in the file if all robots come from MJCF files. With longer
        ones, bodies penetrate each other deeper.
        """
        self.settings.physics_steps = checks.integer(step_sub, "env.set_physics_step_sub(step_sub)", minimum=1)
        self.settings.steps_are_exact = True

    def use_physics_of_1_4(self, value: bool = True) -> None:
        """Set whether driven robots are as slow as in the engine of MORSE 1.4, to which old tests were adjusted.

        Friction and damping then reduce their speeds, robots on four wheels turn 2 % less, and the origin on the Earth
        is rounded to single precision. Sleeps of clients end a tick later, after the messages of that tick. Images of
        cameras have the colours of MORSE 1.4: lamps add up without tone mapping, and nothing shines or mirrors.
        """
        self.settings.physics_of_1_4 = checks.boolean(value, "env.use_physics_of_1_4(value)")
        if value:
            logger.info("%s: driven robots have the friction and damping of MORSE 1.4", frames.source_line())

    def set_time_strategy(self, strategy: TimeStrategies) -> None:
        """Choose how simulated time relates to the wall clock.

        Args:
            strategy: ``TimeStrategies.BestEffort`` or ``TimeStrategies.FixedSimulationStep``; ``FixedSimulationStep``
                does not change the frequency of the scene.
        """
        if isinstance(strategy, bool) or strategy not in list(TimeStrategies):
            names = ", ".join(f"TimeStrategies.{s.name}" for s in TimeStrategies)
            raise ValueError(f"env.set_time_strategy takes one of {names}; got {checks.shown(strategy)}")
        self.settings.time_strategy = TimeStrategies(strategy)

    def set_time_scale(self, slowdown_by: float | None = None, accelerate_by: float | None = None) -> None:
        """Run slower or faster than the wall clock; exactly one of the two factors must be given.

        Raises:
            ValueError: none or both are given, or the scale is too small.
        """
        if (slowdown_by is None) == (accelerate_by is None):
            raise ValueError("env.set_time_scale takes either slowdown_by=... or accelerate_by=...")
        if slowdown_by is not None:
            scale = 1.0 / checks.number(slowdown_by, "env.set_time_scale(slowdown_by)", above=0.0)
        else:
            scale = checks.number(accelerate_by, "env.set_time_scale(accelerate_by)", above=0.0)
        if scale < SLOWEST:
            raise ValueError(f"env.set_time_scale: at least {SLOWEST:g} times as fast as the wall clock, got {scale:g}")
        self.settings.time_scale = scale

    def simulator_frequency(
        self,
        base_frequency: float = 60.0,
        logic_step_max: int = 20,
        physics_step_max: int = 20,
        **earlier: object,
    ) -> None:
        """Set the number of ticks per simulated second, independent of the frequencies of the components.

        Args:
            base_frequency: Hz, 0.1 to 10,000.
            logic_step_max: accepted for old scripts; all ticks have the same length.
            physics_step_max: accepted for old scripts.
            **earlier: arguments of earlier versions, as plug-ins understand them.
        """
        if earlier:
            known = {"base_frequency": base_frequency}
            base_frequency = call_of_today(self, "simulator_frequency", known, earlier)["base_frequency"]
        what = "env.simulator_frequency(base_frequency)"
        # at a lower frequency a tick would take minutes, because the physics steps stay short
        self.settings.frequency = checks.number(base_frequency, what, minimum=0.1, maximum=HIGHEST_FREQUENCY)
        checks.integer(logic_step_max, "env.simulator_frequency(logic_step_max)", minimum=1)
        checks.integer(physics_step_max, "env.simulator_frequency(physics_step_max)", minimum=1)
        self._auto_tune = False

    def use_internal_syncer(self) -> None:
        """Accepted for old scripts."""
        self.settings.internal_syncer = True

    def use_vsync(self, vsync: str) -> None:
        """Accepted for old scripts; the argument is only validated."""
        checks.choice(vsync, _VSYNC, "env.use_vsync(vsync)")

    def use_relative_time(self, value: bool = True) -> None:
        """Set whether simulated time begins at 0 instead of the present time."""
        self.settings.relative_time = checks.boolean(value, "env.use_relative_time(value)")

    def set_start_date(self, date: str) -> None:
        """Set the date at which simulated time begins: time is then in seconds since 1970, as with absolute time.

        Magnetometers and GPS receivers have this date, and runs are repeatable.

        Args:
            date: ``2026-11-23`` or ``2026-11-23T12:00:00+01:00`` (ISO 8601), UTC unless it has another time zone.

        Raises:
            MorseBuilderError: it is not a date.
        """
        self.settings.start_time = checks.date(date, "env.set_start_date(date)")
        self.settings.relative_time = False

    def set_seed(self, seed: int) -> None:
        """Set the seed of all random numbers; the same seed gives the same run."""
        self.settings.seed = checks.integer(seed, "env.set_seed(seed)", minimum=0)

    def cameras_on(self, place: int | str = "processes") -> None:
        """Render camera images in a number of other processes, ``"processes"`` for one on each processor.

        ``"ray://auto"`` stands for those of the cluster of Ray of this machine.

        ``morse.load(cameras_on=…)`` and ``morse run --cameras-on`` override it.
        """
        image_workers(place)  # checks it
        self.settings.cameras_on = place

    def set_auto_start(self, value: bool = True) -> None:
        """Set whether the simulation starts immediately, or waits for a client or the live view."""
        self.settings.auto_start = checks.boolean(value, "env.set_auto_start(value)")

    # --- middlewares ------------------------------------------------------------------------

    def add_default_interface(self, interface: str) -> None:
        """Connect all components of all robots, and the services of the simulation, to a middleware.

        Existing streams of the script are not changed. Robots that are spawned later are connected as well.

        Args:
            interface: name of a middleware.

        Raises:
            MorseMiddlewareError: the middleware is unknown.
        """
        middleware = registry.middleware(checks.text(interface, "env.add_default_interface(interface)"))
        if middleware.request_manager is not None and middleware.request_manager not in self._simulation_managers:
            self._simulation_managers.append(middleware.request_manager)
        if middleware.name not in self._default_interfaces:
            self._default_interfaces.append(middleware.name)

    def add_service(self, datastream: str) -> None:
        """Offer the services of the simulation on an additional middleware; the socket always offers them.

        Raises:
            MorseMiddlewareError: the middleware is unknown.
        """
        manager = registry.request_manager(checks.text(datastream, "env.add_service(datastream)"))
        if manager not in self._simulation_managers:
            self._simulation_managers.append(manager)

    def add_interface(self, interface: str) -> None:
        """Offer the services of the simulation on an additional middleware, as `add_service` does.

        Raises:
            MorseMiddlewareError: the middleware is unknown.
        """
        middleware = registry.middleware(checks.text(interface, "env.add_interface(interface)"))
        if middleware.request_manager is not None:
            self.add_service(middleware.name)

    def add_stream(self, datastream: str, *_: object, **__: object) -> None:
        """Accepted for old scripts, without effect, because the simulation itself has no data to stream.

        Raises:
            MorseMiddlewareError: the middleware is unknown.
        """
        registry.stream_manager(checks.text(datastream, "env.add_stream(datastream)"))
        notice("env.add_stream has no effect: the simulation itself has no data to stream")

    def configure_service(self, datastream: str, component: Interfaces | None = None) -> None:
        """Old name of `add_service`."""
        notice("env.configure_service is an old name, write env.add_service", "configure_service", "add_service")
        if component is None:
            self.add_service(datastream)
        elif isinstance(component, Interfaces):
            component.add_service(datastream)
        else:
            raise TypeError(f"env.configure_service(component) takes a component, got {checks.shown(component)}")

    def configure_stream_manager(self, stream_manager: str, **kwargs: object) -> None:
        """Set options of a middleware, e.g. ``configure_stream_manager('socket', time_sync=True, sync_port=5000)``.

        Raises:
            MorseMiddlewareError: the middleware is unknown.
            OptionError: the middleware has no such option, or the value is not valid.
        """
        manager = registry.stream_manager(checks.text(stream_manager, "env.configure_stream_manager(stream_manager)"))
        self._manager_options.setdefault(manager, {}).update(manager_options(manager, kwargs))

    def configure_multinode(
        self,
        protocol: str = "socket",
        server_address: str = "localhost",
        server_port: str | int = "65000",
        distribution: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        """Distribute the simulation over several nodes, which all run this scene.

        Each node, ``morse run --name NODE``, simulates its robots with their components, and shows the others where the
        server says that they are. The server is a program of its own (docs: several nodes).

        Args:
            protocol: ``socket``; ``hla`` of MORSE 1.4 is not available.
            server_address: address of the multi-node server.
            server_port: its TCP port.
            distribution: name of a node to the names of the robots that it simulates; without it, each node simulates
                all robots of its script, and sends their poses to the server.
        """
        what = "env.configure_multinode({})"
        checks.choice(protocol, _PROTOCOLS, what.format("protocol"))
        middleware = registry.middleware_of_nodes(protocol)
        if middleware is None:
            reason = (
                "no installed middleware exchanges poses between simulations"
                if registry.middleware_of_nodes("socket") is None
                else "no run-time infrastructure of HLA with Python bindings is distributed; use protocol='socket'"
            )
            raise MorseMultinodeError(f"env.configure_multinode(protocol={protocol!r}): {reason}")
        # 1.4 documents the port as a text
        port = int(server_port) if isinstance(server_port, str) and server_port.isdecimal() else server_port
        number = checks.integer(port, what.format("server_port"), minimum=1)
        if number > 65535:
            raise ValueError(f"{what.format('server_port')} takes a number from 1 to 65535, got {number}")
        address = checks.text(server_address, what.format("server_address"))
        shares: dict[str, list[str]] = {}
        for node, robots in dict(distribution or {}).items():
            robots = checks.names(robots, what.format("distribution"))
            # a script may number its nodes
            node = str(node) if isinstance(node, int) else node
            shares[checks.text(node, what.format("distribution"))] = robots
        self._distribution, self._distribution_where = shares, frames.source_line()
        self.configure_stream_manager(middleware.name, server_address=address, server_port=number)

    def set_log_level(self, component: str, level: str) -> None:
        """Set the log level of ``morse.<component>``: ``DEBUG``, ``INFO``, ``WARNING``, ``ERROR`` or ``CRITICAL``."""
        name = checks.text(component, "env.set_log_level(component)")
        if not log.is_component(name):
            expectation = "the name of a module, such as 'core.request_manager'"
            raise ValueError(f"env.set_log_level(component) takes {expectation}, got {name!r:.80}")
        word = checks.text(level, "env.set_log_level(level)").upper()
        self._log_levels[name] = checks.choice(word, _LOG_LEVELS, "env.set_log_level(level)")

    def _init_time(self) -> None:
        self._gravity_given = False
        self._simulation_managers = [registry.request_manager("socket")]
        self._default_interfaces = []
        self._manager_options = {}
        self._distribution = None
        self._distribution_where = None
        self._log_levels = {}
