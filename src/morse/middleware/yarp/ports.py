"""The ports of a simulation, shared by its streams and its services, and their registration."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from morse.core.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.core.quoting import shown
from morse.core.validation.options import checked_options, with_defaults
from morse.middleware.socket.listener import listen
from morse.middleware.yarp.mapping import JSON_STREAM_MANAGER, MANAGER_OPTIONS, STREAM_MANAGER
from morse.middleware.yarp.names import Address, NameServer
from morse.middleware.yarp.port import Port

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context

logger = logging.getLogger(__name__)

#: wall-clock seconds between two attempts to reach the name server, and between two checks that it knows the ports
_RETRY, _CHECK = 1.0, 5.0
_EVERYWHERE = ("0.0.0.0", "::", "")
_NAME = re.compile(r"/[^\s:()\"\[\]{}]{1,500}$")
_made: WeakKeyDictionary[Context, Ports] = WeakKeyDictionary()


class Ports:
    """Opens ports, and registers them as soon as there is a name server.

    Args:
        context: the simulation.
        options: of ``env.configure_stream_manager('yarp', ...)``.

    Attributes:
        users: number of users.
        names: the name server.
    """

    def __init__(self, context: Context, options: dict[str, Any]) -> None:
        self._context = context
        self.users = 0
        self.names = NameServer(options["host"], options["port"])
        self._prefix = options["prefix"]
        self._ports: dict[str, tuple[Port, Address]] = {}
        self._owners: dict[str, str] = {}
        self._registered: set[str] = set()
        self._complaints = Complaints(logger)
        self._changed: asyncio.Event | None = None
        self._task: asyncio.Task[None] | None = None
        self._was_there = False
        context.network.call(self._begin())

    async def _begin(self) -> None:
        self._changed = asyncio.Event()
        self._task = asyncio.ensure_future(self._keep_registered())

    def name(self, path: str) -> str:
        """The name of a port from its path below the prefix."""
        return f"/{self._prefix}/{path}"

    def open(self, name: str, owner: str, take: Callable[[list[Any]], object] | None = None) -> Port:
        """Open a port.

        Args:
            name: absolute, ``/morse/robot/pose/out``.
            owner: name of the component, for messages.
            take: called in the network loop with the values of each bottle that arrives.

        Raises:
            MorseMiddlewareError: the name is not one of YARP, or another component has the port.
        """
        if not _NAME.match(name):
            raise MorseMiddlewareError(f"{owner}: the port is {shown(name)}, expected a name such as '/lab/pose'")
        if name in self._owners:
            raise MorseMiddlewareError(
                f"{owner}: the port {name} is that of {self._owners[name]}; set port='...' for one of them"
            )
        listener = listen(self._context.host, (0,))
        number = listener.getsockname()[1]
        host = "..." if self._context.host in _EVERYWHERE else self._context.host
        port = Port(name, self.names, take)
        self._context.network.call(port.open(listener))
        self._owners[name] = owner
        self._context.network.post(self._add, name, port, Address(host, number))
        return port

    def _add(self, name: str, port: Port, address: Address) -> None:
        self._ports[name] = (port, address)
        if self._changed is not None:
            self._changed.set()

    def close(self, port: Port) -> None:
        """Close a port, and remove it from the name server."""
        if self._owners.pop(port.name, None) is not None:
            self._context.network.call(self._close(port))

    async def _close(self, port: Port) -> None:
        self._ports.pop(port.name, None)
        await port.close()
        if port.name in self._registered:
            self._registered.discard(port.name)
            with contextlib.suppress(OSError):
                await self.names.unregister(port.name)

    def release(self) -> None:
        """End, if nobody uses it any more."""
        self.users -= 1
        if self.users <= 0:
            self._context.network.call(self._end())

    async def _end(self) -> None:
        if self._task is not None:
            self._task.cancel()
        await asyncio.gather(*(self._close(port) for port, _ in list(self._ports.values())))

    # -- registration ------------------------------------------------------------------------

    async def _keep_registered(self) -> None:
        """Register new ports at once; and all of them again if the name server has forgotten them."""
        assert self._changed is not None
        while True:
            self._changed.clear()
            try:
                await self._register()
                pause = _CHECK
            except OSError as error:
                self._registered.clear()
                self._tell(False, f"there is no name server at {self._place} ({error}); the simulation runs without it")
                pause = _RETRY
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._changed.wait()

    @property
    def _place(self) -> str:
        return f"{self.names.address.host}:{self.names.address.port}"

    async def _register(self) -> None:
        for name, (_, address) in list(self._ports.items()):
            if name in self._registered:
                continue
            entered = await self.names.register(name, address)
            if entered is None or entered.port != address.port:
                self._complaints.warn(name, f"yarp: the name server does not register {name} (its answer: {entered})")
                continue
            self._registered.add(name)
        if self._registered:
            # a name server that was restarted knows none of them
            one = next(iter(self._registered))
            known = await self.names.query(one)
            if one in self._ports and (known is None or known.port != self._ports[one][1].port):
                self._registered.clear()
                await self._register_again()
            self._tell(True, f"{len(self._registered)} ports are registered at the name server {self._place}")

    async def _register_again(self) -> None:
        for name, (_, address) in list(self._ports.items()):
            if await self.names.register(name, address) is not None:
                self._registered.add(name)

    def _tell(self, is_there: bool, text: str) -> None:
        if is_there and not self._was_there:
            logger.info("yarp: %s", text)
        elif not is_there:
            self._complaints.warn("absent", f"yarp: {text}")
        self._was_there = is_there


def ports_of(context: Context) -> Ports:
    """The ports of a simulation; the caller has to call `Ports.release` at the end.

    Raises:
        OptionError: an option of ``env.configure_stream_manager('yarp', ...)`` has an invalid value.
    """
    known = _made.get(context)
    if known is None or known.users <= 0:
        options = context.scene.manager_options
        given = {**options.get(JSON_STREAM_MANAGER, {}), **options.get(STREAM_MANAGER, {})}
        checked = checked_options("yarp", MANAGER_OPTIONS, given)
        known = _made[context] = Ports(context, with_defaults(MANAGER_OPTIONS, checked))
    known.users += 1
    return known
