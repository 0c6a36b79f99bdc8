"""The ports of a simulation, shared by its streams and its services, and their registration."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
import threading
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar
from weakref import WeakKeyDictionary

from morse.core.clients.budgets import ENTRY, PARSED, Budget
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown
from morse.core.validation.fields import checked_options, with_defaults
from morse.plugins.yarp import JSON_STREAM_MANAGER, MANAGER_OPTIONS, STREAM_MANAGER
from morse.plugins.yarp.port import Port
from morse.plugins.yarp.wire import Address, NameServer, is_alive
from morse.wire.listener import listen

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.values import Options


_T = TypeVar("_T")


class WaitingBottles(Generic[_T]):
    """A queue that drops the oldest bottles if there are too many, or if their values take too much memory.

    Args:
        most: maximum number of bottles.
        complaints: logs and counts the losses; None without a log.
        what: name of the bottles in the log.
    """

    def __init__(self, most: int, complaints: Complaints | None = None, what: str = "bottles") -> None:
        self._most, self._memory = most, Budget()
        self._complaints = complaints
        self._text = f"{what} arrive faster than they are read: the oldest are lost"
        self._lock = threading.Lock()
        self._queue: deque[tuple[_T, int]] = deque()

    def __len__(self) -> int:
        return len(self._queue)

    def append(self, bottle: _T, count: int) -> None:
        """Add a bottle.

        Args:
            bottle: its values.
            count: number of bytes from which they were read.
        """
        size = PARSED * count + ENTRY
        with self._lock:
            while self._queue and (len(self._queue) >= self._most or size > self._memory.left):
                self._memory.give(self._queue.popleft()[1])
                if self._complaints is not None:
                    self._complaints.warn(self._text, self._text)
            self._memory.force(size)
            self._queue.append((bottle, size))

    def popleft(self) -> _T:
        """Remove the oldest bottle, and return it.

        Raises:
            IndexError: there is none.
        """
        with self._lock:
            bottle, size = self._queue.popleft()
            self._memory.give(size)
            return bottle


logger = logging.getLogger(__name__)

#: wall-clock seconds between two attempts to reach the name server, and between two checks that it knows the ports
_RETRY, _CHECK = 1.0, 5.0
#: wall-clock seconds in which the name server is told the end of the simulation
_FAREWELL = 2.0
#: more seconds for each port, and the longest farewell
_EACH, _LONGEST = 0.02, 7.0
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

    def __init__(self, context: Context, options: Options) -> None:
        self._context = context
        self.users = 0
        self.names = NameServer(options["host"], options["port"])
        self._prefix = options["prefix"]
        self._ports: dict[str, tuple[Port, Address]] = {}
        self._owners: dict[str, str] = {}
        #: names that the server knows, as far as is known, and all that were entered
        self._own_names: set[str] = set()
        self._entries: set[str] = set()
        self._complaints = Complaints(logger)
        self._change: asyncio.Event | None = None
        self._task: asyncio.Task[None] | None = None
        self._closing: set[asyncio.Task[None]] = set()
        self._round = 0
        self._ending = False
        self._was_there = False
        context.network.call(self._begin())

    async def _begin(self) -> None:
        self._change = asyncio.Event()
        self._task = asyncio.ensure_future(self._keep_registered())

    def name(self, path: str) -> str:
        """The name of a port from its path below the prefix."""
        return f"/{self._prefix}/{path}"

    def open(self, name: str, owner: str, take: Callable[[list[object], int], object] | None = None) -> Port:
        """Open a port.

        Args:
            name: absolute, ``/morse/robot/pose/out``.
            owner: name of the component, for messages.
            take: called in the network loop with the values of each bottle that arrives, and the number of its bytes.

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
        port = Port(name, self.names, take, self._context.network.arrivals)
        self._context.network.call(port.open(listener))
        self._owners[name] = owner
        self._context.network.post(self._add, name, port, Address(host, number))
        return port

    def _add(self, name: str, port: Port, address: Address) -> None:
        self._ports[name] = (port, address)
        if self._change is not None:
            self._change.set()

    def close(self, port: Port) -> None:
        """Close a port, and remove it from the name server; waits for neither."""
        if self._owners.pop(port.name, None) is not None:
            self._context.network.post(self._begin_close, port)

    def _begin_close(self, port: Port) -> None:
        task = self._context.network.loop.create_task(self._close(port))
        self._closing.add(task)
        task.add_done_callback(self._closing.discard)

    def _has(self, port: Port) -> bool:
        return self._ports.get(port.name, (None,))[0] is port

    async def _close(self, port: Port) -> None:
        if self._has(port):
            del self._ports[port.name]
        self._own_names.discard(port.name)
        await port.close()
        if port.name in self._entries and port.name not in self._ports:
            self._entries.discard(port.name)
            with contextlib.suppress(OSError):
                await self.names.unregister(port.name)
        if port.name in self._ports and self._change is not None:
            # a port of the same name was opened meanwhile: enter it, whoever was first
            self._own_names.discard(port.name)
            self._change.set()

    def release(self) -> None:
        """End, if nobody uses it any more."""
        self.users -= 1
        if self.users <= 0:
            self._context.network.call(self._end())

    async def _end(self) -> None:
        self._ending = True
        if self._task is not None and self._change is not None:
            # a request that was sent is awaited: its port might be entered after it was removed
            self._change.set()
            await asyncio.wait([self._task], timeout=_FAREWELL)
            self._task.cancel()
        for port, _ in list(self._ports.values()):
            self._begin_close(port)
        if self._closing:
            _, late = await asyncio.wait(self._closing, timeout=min(_FAREWELL + _EACH * len(self._closing), _LONGEST))
            for task in late:
                task.cancel()

    # -- registration ------------------------------------------------------------------------

    async def _keep_registered(self) -> None:
        """Register new ports at once; and all of them again if the name server has forgotten them."""
        assert self._change is not None
        while not self._ending:
            self._change.clear()
            try:
                await self._register()
                pause = _CHECK
            except OSError as error:
                self._own_names.clear()
                self._tell(False, f"there is no name server at {self._place} ({error}); the simulation runs without it")
                pause = _RETRY
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._change.wait()

    @property
    def _place(self) -> str:
        return f"{self.names.address.host}:{self.names.address.port}"

    async def _register(self) -> None:
        if self._own_names:
            # a name server that was restarted does not know them; each time, another one is asked for
            self._round += 1
            one = sorted(self._own_names)[self._round % len(self._own_names)]
            holder = await self.names.query(one)
            if one in self._ports and (holder is None or holder.port != self._ports[one][1].port):
                self._own_names.clear()
        for name, (port, address) in list(self._ports.items()):
            if self._ending:
                return
            if name in self._own_names or not await self._claim(name, address):
                continue
            self._entries.add(name)
            if self._has(port):
                self._own_names.add(name)
            elif name not in self._ports:  # closed meanwhile
                self._entries.discard(name)
                await self.names.unregister(name)
        if self._own_names:
            self._tell(True, f"{len(self._own_names)} ports are registered at the name server {self._place}")

    async def _claim(self, name: str, address: Address) -> bool:
        holder = await self.names.query(name)
        if holder is not None and holder.port != address.port and await is_alive(holder):
            self._complaints.warn(
                "taken",
                f"yarp: {name} is the port of another program, perhaps a simulation, at {holder.host}:{holder.port}; "
                "set another prefix: env.configure_stream_manager('yarp', prefix='...')",
            )
            return False
        entry = await self.names.register(name, address)
        if entry is None or entry.port != address.port:
            self._complaints.warn(name, f"yarp: the name server does not register {name} (its answer: {entry})")
            return False
        return True

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
    present = _made.get(context)
    if present is None or present.users <= 0:
        options = context.scene.manager_options
        values = {**options.get(JSON_STREAM_MANAGER, {}), **options.get(STREAM_MANAGER, {})}
        checked_values = checked_options("yarp", MANAGER_OPTIONS, values)
        present = _made[context] = Ports(context, with_defaults(MANAGER_OPTIONS, checked_values))
    present.users += 1
    return present
