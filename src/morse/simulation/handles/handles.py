"""The interface to robots and components for programs that run the simulation in their own process.

It is the interface of `pymorse`, so that a test may run against a simulation in the process or over sockets.
"""

from __future__ import annotations

import contextlib
import logging
import math
from typing import TYPE_CHECKING, Any

from morse.simulation.handles.component_handles import ComponentHandle, RobotHandle, component_handles
from morse.simulation.handles.local_requests import LocalRequests
from morse.simulation.handles.world_changes import WorldChanges

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.clock import Clock
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.simulation.handles.futures import LocalFuture

logger = logging.getLogger(__name__)

#: what a program of a user calls, for the completion of names
_PUBLIC = """
activate before_physics call cancel clock close contacts context deactivate delete failures is_up measure observers
pause paused picture place quit record record_inputs replay reset restart restart_robot restore resume robots rpc
rpc_t run save scene seed set_color set_friction set_light set_mass set_texture show sleep spawn state_hash step stop
streams ticks time view world
"""


class Handles(WorldChanges):
    """The part of `morse.simulation.simulation.Simulation` with the interface of `pymorse.Morse`."""

    context: Context
    clock: Clock
    finished: bool

    def __init__(self) -> None:
        super().__init__()
        self._requests = LocalRequests(self.context, self.step)
        self.context.services.add_internal(self._requests)
        self._handles: dict[str, object] | None = None
        self._names: set[str] = set()
        self._by_full_name: dict[str, ComponentHandle] = {}
        self._failure: tuple[BaseException, str] | None = None

    def step(self, ticks: int = 1, *, measure: bool | Sequence[str] = False) -> None:
        """Run ``ticks`` ticks."""
        raise NotImplementedError

    def stop(self) -> None:
        """End a run after this tick."""
        raise NotImplementedError

    def close(self) -> None:
        """End the simulation."""
        raise NotImplementedError

    def _check_open(self) -> None:
        if self.finished:
            raise RuntimeError("this simulation is closed: load the scene again")

    def restart(self, seed: int | None = None) -> None:
        """Restart the simulation."""
        raise NotImplementedError

    # -- robots ----------------------------------------------------------------------------

    @property
    def robots(self) -> list[str]:
        """The names of the robots as attribute names."""
        return [name for name, handle in self._all_handles().items() if isinstance(handle, RobotHandle)]

    def _all_handles(self) -> dict[str, object]:
        if self._handles is None:
            self._handles = component_handles(self, self._by_full_name)
            for name in self._handles:
                if (hasattr(type(self), name) or name in vars(self)) and name not in self._names:
                    self._names.add(name)
                    logger.warning("the attribute '%s' already exists: access the robot as simulation[%r]", name, name)
        return self._handles

    def components_changed(self) -> None:
        """Called when robots were added or removed, or the components are new instances."""
        self._handles = None
        for handle in list(self._by_full_name.values()):
            handle.listen_again()

    def part_failed(self, error: BaseException, who: str) -> bool:
        """Stop after this tick, for `step` or `run` to raise the error of a part; False if they will raise another."""
        if self._failure is not None:
            return False
        self._failure = error, who
        self.stop()
        return True

    def _raise_failure(self) -> None:
        failure, self._failure = self._failure, None
        if failure is None:
            return
        error, who = failure
        with contextlib.suppress(Exception):  # the class of the error may be a user's
            BaseException.add_note(error, f"{who} failed in tick {self.ticks} of the simulation")
        raise error

    def component_replaced(self, before: Object, after: Object) -> None:
        """Called when a component was replaced by another one; subscriptions are kept."""
        waiting = [handle for handle in (self._handles or {}).values() if isinstance(handle, ComponentHandle)]
        while waiting:
            handle = waiting.pop()
            handle.replaced(before, after)
            waiting += handle.parts.values()

    def __getitem__(self, name: str) -> Any:
        """Return the robot of that name; ``<name>s`` returns the list of robots that a loop of the scene created.

        Raises:
            KeyError: there is no such robot.
        """
        handles = self._all_handles()
        if name not in handles:
            raise KeyError(_no_robot(name, list(handles)))
        return handles[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(f"a simulation has no attribute '{name}'")
        handles = self._all_handles()
        if name not in handles:
            # with a name, but without an object, Python adds no suggestion of its own
            raise AttributeError(_no_attribute(name, list(handles), dir(type(self))), name=name)
        return handles[name]

    def __dir__(self) -> list[str]:
        """The names for programs of users, and the robots; other parts of MORSE use further names."""
        return sorted({*_PUBLIC.split(), *(() if self.finished else self._all_handles())})

    # -- services --------------------------------------------------------------------------

    def call(self, component: str, service: str, *arguments: object) -> LocalFuture:
        """Call a service without waiting; the future contains the result.

        Raises:
            TypeError: the number of arguments is wrong.
            pymorse.MorseServiceFailed: there is no such service, the arguments are wrong, or the service failed
                immediately.
        """
        self._check_open()
        return self._requests.call(component, service, *arguments)

    def rpc(self, component: str, service: str, *arguments: object) -> object:
        """Call a service, run the simulation until it has ended, and return its result."""
        return self.call(component, service, *arguments).result()

    def rpc_t(self, timeout: float | None, component: str, service: str, *arguments: object) -> object:
        """Call a service, and return its result.

        Raises:
            TimeoutError: the service has not ended after ``timeout`` simulated seconds; it continues.
        """
        return self.call(component, service, *arguments).result(timeout)

    def cancel(self, future: LocalFuture) -> None:
        """Interrupt a running service."""
        future.cancel()

    def activate(self, component: str | ComponentHandle) -> None:
        """Activate a component, given its full name."""
        self.rpc("simulation", "activate", getattr(component, "fqn", component))

    def deactivate(self, component: str | ComponentHandle) -> None:
        """Deactivate a component, given its full name."""
        self.rpc("simulation", "deactivate", getattr(component, "fqn", component))

    def streams(self) -> list[str]:
        """Return the names of the components with a stream in the scene."""
        return [c.name for c in self.context.scene.components if c.streams]

    # -- time and life cycle ---------------------------------------------------------------

    def time(self) -> float:
        """Simulated time, s."""
        return self.clock.time

    @property
    def ticks(self) -> int:
        """Number of completed ticks since the start."""
        return self.clock.tick

    def sleep(self, time: float) -> None:
        """Run the simulation for ``time`` simulated seconds."""
        self.step(max(0, math.ceil(time * self.clock.frequency - 1e-9)))

    def reset(self, seed: int | None = None) -> None:
        """Move every object to its initial pose; with a seed, restart the simulation with it."""
        if seed is None:
            self.rpc("simulation", "reset_objects")
        else:
            self.restart(seed)

    def is_up(self) -> bool:
        """Whether the simulation is not closed."""
        return not self.finished

    def quit(self) -> None:
        """End the simulation."""
        self.close()


def _no_robot(name: str, names: list[str]) -> str:
    from morse.core.reports.hints import nearest

    return f"no robot '{name}' in the simulation{nearest(name, names)}"


def _no_attribute(name: str, robots: list[str], members: list[str]) -> str:
    from morse.core.reports.hints import closest, nearest

    near = closest(name, [*robots, *(member for member in members if not member.startswith("_"))])
    hint = nearest(name, [near] if near else robots)
    return f"a simulation has no attribute '{name}', and there is no robot '{name}' in it{hint}"
