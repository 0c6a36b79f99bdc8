"""The interface to robots and components for programs that run the simulation in their own process.

It is the interface of `pymorse`, so that a test may run against a simulation in the process or over sockets.
"""

from __future__ import annotations

import contextlib
import logging
import math
from typing import TYPE_CHECKING, Any

from morse.core.context import acting
from morse.core.exceptions import MorseError, MorseRPCNbArgsError
from morse.core.reports.faults import summary
from morse.core.request_manager import OfferedService, Outcome, RequestManager
from morse.simulation.handles.component_handles import ComponentHandle, LocalFuture, RobotHandle, component_handles
from morse.simulation.handles.world_changes import WorldChanges

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable, Sequence

    from morse.core.abstractobject import AbstractObject
    from morse.core.clock import Clock
    from morse.core.context import Context
    from morse.core.interfaces import Offering
    from morse.core.object import Object


# Service calls from within the process.


class LocalRequests(RequestManager):
    """Offers all services of all components to the process; services are looked up when they are called.

    Args:
        tick: function that runs one tick, for a caller that waits for the end of a service.
    """

    title = "this simulation"
    waiting = ()

    def __init__(self, context: Context, tick: Callable[[], object]) -> None:
        super().__init__(context)
        self._context = context
        self._tick = tick
        self._entries: dict[tuple[str, str], tuple[AbstractObject, OfferedService]] = {}
        self._futures: dict[uuid.UUID, LocalFuture] = {}

    def initialization(self) -> bool:
        """Do nothing: no ports or connections are needed."""
        return True

    def finalization(self) -> bool:
        """Do nothing: there is nothing to release."""
        return True

    def main(self) -> None:
        """Do nothing: requests are executed when they are made."""

    def call(self, component: str, service: str, *arguments: object) -> LocalFuture:
        """Call a service.

        Raises:
            TypeError: the number of arguments is wrong.
            pymorse.MorseServiceFailed: there is no such service, the arguments are wrong, or the service failed.
        """
        with acting(self._context):
            try:
                is_complete, outcome = self.on_incoming_request(component, service, list(arguments))
            except MorseRPCNbArgsError as error:
                raise TypeError(str(error)) from None
            except Exception as error:
                from pymorse.errors import MorseServiceFailed

                text = str(error) if isinstance(error, MorseError) else summary(error)
                raise MorseServiceFailed(text) from error
        future = LocalFuture(self._tick, self._context.clock, self._context.guard)
        if is_complete:
            future.finish(outcome)
        else:
            self._futures[outcome] = future
            future.abort = lambda: self._abort(outcome)
            self.answer()  # the service may already have ended
        return future

    def _abort(self, request_id: uuid.UUID) -> None:
        with acting(self._context):
            self.abort_request(request_id)
            self.answer()

    def _ended(self, request_id: uuid.UUID, outcome: object) -> None:
        super()._ended(request_id, outcome)
        if request_id in self._futures:
            self.answer()

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """Set the outcome of a service that has ended."""
        future = self._futures.pop(request_id, None)
        if future is not None:
            future.finish(result)

    # -- looking up services ---------------------------------------------------------------

    def find(self, component: str, service: str) -> OfferedService | None:
        """Return the present service of a component."""
        owner, entry = self._entries.get((component, service), (None, None))
        if owner is not None and any(owner is obj for obj in self._objects(component)):
            return entry
        for obj in self._objects(component):
            for declaration in obj.services():
                if declaration.name == service:
                    entry = OfferedService.of(getattr(obj, declaration.attribute), service, declaration.asynchronous)
                    self._entries[component, service] = obj, entry
                    return entry
        return None

    def _objects(self, name: str) -> list[AbstractObject]:
        component = self._context.component(name) or self._context.overlays.get(name)
        return [component] if component is not None else [o for o in self._context.service_objects if o.name() == name]

    def services(self) -> dict[str, list[str]]:
        """The services by component."""
        context = self._context
        listing: dict[str, list[str]] = {}
        everything: dict[str, Offering] = {**context.robots, **context.components, **context.overlays}
        for name, obj in [*everything.items(), *((o.name(), o) for o in context.service_objects)]:
            listing.setdefault(name, []).extend(declaration.name for declaration in obj.services())
        return listing


logger = logging.getLogger(__name__)

#: what a program of a user calls, for the completion of names
_PUBLIC = """
activate before_physics call cancel clock close contacts context deactivate delete failures is_up measure observers
pause paused picture place quit record record_inputs replay reset restart restart_robot restore resume robots rpc
rpc_t run save scene seed set_color set_friction set_light set_mass set_texture show show_task sleep spawn
state_hash step stop streams ticks time view world
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
    from morse.core.reports.quoting import nearest

    return f"no robot '{name}' in the simulation{nearest(name, names)}"


def _no_attribute(name: str, robots: list[str], members: list[str]) -> str:
    from morse.core.reports.quoting import closest, nearest

    near = closest(name, [*robots, *(member for member in members if not member.startswith("_"))])
    hint = nearest(name, [near] if near else robots)
    return f"a simulation has no attribute '{name}', and there is no robot '{name}' in it{hint}"
