"""The event loop of all network traffic, run by one thread at a time."""

from __future__ import annotations

import asyncio
import os
import selectors
import threading
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

from morse.core.clients.budgets import Arrivals

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Coroutine

_T = TypeVar("_T")

#: longest time for which a borrowed loop may not be run, wall-clock seconds
_UNSERVED = 0.002
#: polling time before sleeping, wall-clock seconds, for a thread whose last wait was shorter than this; waking a thread
#: up takes longer than a tick, and a client in lockstep answers within this time. A thread that waits longer sleeps
_WATCH = 0.0002 if (os.cpu_count() or 1) > 1 else 0.0


class _WatchfulSelector(selectors.DefaultSelector):
    """A selector that polls for events for a limited time before it sleeps.

    Attributes:
        until: end of the polling (`time.perf_counter`).
    """

    until = 0.0

    def ready(self) -> list[tuple[selectors.SelectorKey, int]]:
        """The sockets that are ready now."""
        return super().select(0.0)

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """The sockets that are ready, at the latest after ``timeout`` seconds."""
        if timeout is None or timeout > 0.0:
            begin = perf_counter()
            until = self.until if timeout is None else min(self.until, begin + timeout)
            now = begin
            while now < until:
                if ready := self.ready():
                    return ready
                now = perf_counter()
            if timeout is not None:
                timeout = max(0.0, timeout - (now - begin))
        return super().select(timeout)


class _Loop(asyncio.SelectorEventLoop):
    """A loop whose servers can accept their connections through an acceptor."""

    async def create_server(  # type: ignore[override] # one more option
        self, protocol_factory: Callable[[], asyncio.BaseProtocol], *args: Any, acceptor: Any = None, **options: Any
    ) -> asyncio.AbstractServer:
        """See `asyncio.loop.create_server`.

        Args:
            acceptor: a `StreamAcceptor` of `clients.acceptors`; ``protocol_factory`` then makes its protocols.
        """
        if acceptor is None:
            return await super().create_server(protocol_factory, *args, **options)
        listener = await super().create_server(protocol_factory, *args, start_serving=False, **options)
        listeners = [sock.dup() for sock in listener.sockets]
        listener.close()
        server: asyncio.AbstractServer = acceptor.serve(listeners, protocol_factory)
        return server


def _has_running_loop() -> bool:
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True


class Network:
    """An asyncio loop in a daemon thread.

    The simulation thread schedules work with `post`, which never blocks; only start-up and shutdown wait for a result
    (`call`).

    A simulation that waits for its clients borrows the loop: `wait` runs the loop in the waiting thread. The request of
    a client, the tick and the answer are then processed in one thread, because two thread switches would take longer
    than the tick. The loop stays borrowed until `give_back` or `tend`.

    Attributes:
        arrivals: the share of the time for what clients send.
    """

    def __init__(self) -> None:
        self.arrivals = Arrivals()
        self._selector = _WatchfulSelector()
        self._loop = _Loop(self._selector)
        self._thread = threading.Thread(target=self._serve, name="morse-network", daemon=True)
        self._is_parked, self._go_on, self._awakened = threading.Event(), threading.Event(), threading.Event()
        self._asked_for = self._ending = self._woken = False
        self._borrower: int | None = None
        self._waits_beside = False
        self._last_service = 0.0
        self._first: dict[int, Callable[[], object]] = {}
        self._unread: list[Callable[[], object]] = []
        self._calls: list[tuple[Callable[..., object], tuple[object, ...]]] = []
        self._alarm: asyncio.TimerHandle | None = None
        self._watchful = False
        self._thread.start()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            while not self._ending:
                self._loop.run_forever()
                if self._asked_for:
                    self._is_parked.set()
                    self._go_on.wait()
                    self._go_on.clear()
        finally:
            pending = asyncio.all_tasks(self._loop)
            for task in pending:
                task.cancel()
            self._loop.run_until_complete(asyncio.gather(*pending, return_exceptions=True))
            self._loop.close()

    @property
    def loop(self) -> asyncio.AbstractEventLoop:
        """The event loop; use it in its callbacks only."""
        return self._loop

    @property
    def is_awaited(self) -> bool:
        """Whether the simulation waits for its clients between its ticks."""
        return self._borrower is not None or self._waits_beside

    def post(self, function: Callable[..., object], *args: object) -> None:
        """Schedule ``function(*args)`` in the thread that runs the loop; after `stop` the call is ignored.

        ``function`` may write to connections and schedule callbacks, but must not assume that the loop is running.
        """
        if self._borrower == threading.get_ident():
            self._calls.append((function, args))
            return
        try:
            self._loop.call_soon_threadsafe(function, *args)
        except RuntimeError:
            if not self._loop.is_closed():
                raise

    def call(self, coroutine: Coroutine[object, object, _T], timeout: float = 10.0) -> _T:
        """Run a coroutine in the network thread and wait for its result.

        Raises:
            TimeoutError: if it takes longer than ``timeout`` seconds of wall-clock time.
        """
        self.give_back()
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(timeout)

    # -- order of received data --------------------------------------------------------------

    def on_readable(self, sock: socket.socket, function: Callable[[], object], *, comes_first: bool = False) -> None:
        """Call ``function`` whenever ``sock`` is readable; to be called in the loop.

        Args:
            comes_first: whether `when_read` calls ``function`` as well. ``function`` must not block, and may be called
                when there are no data.
        """
        self._loop.add_reader(sock, function)
        if comes_first:
            self._first[sock.fileno()] = function

    def ignore(self, sock: socket.socket) -> None:
        """Stop reading from ``sock``; to be called before it is closed."""
        self._loop.remove_reader(sock)
        self._first.pop(sock.fileno(), None)

    def when_read(self, function: Callable[[], object]) -> None:
        """Call ``function()`` after all data that have arrived so far were read; to be called in the loop.

        The loop reads connections in any order. A client that sends a command on one connection and then requests a
        tick on another expects that the tick uses the command. The operating system fills the socket buffers in the
        order of sending, so polling all sockets once after the request was read finds the command.
        """
        if self._borrower is None:
            self._loop.call_soon(self._after_reading, [function])
        else:
            self._unread.append(function)
            self._loop.stop()

    def _after_reading(self, functions: list[Callable[[], object]]) -> None:
        if self._first:
            for key, _ in self._selector.ready():
                reader = self._first.get(key.fd)
                if reader is not None:
                    reader()
        for function in functions:
            function()

    # -- running the loop in the waiting thread ----------------------------------------------

    def wait(self, seconds: float) -> None:
        """Run the event loop in this thread until `wake` is called, at most for about ``seconds``.

        Functions that were posted before are called first. Between two calls of `wait` nothing is received or sent.

        A notebook cell or a coroutine waits inside the running loop of its thread: the network thread then serves
        the clients, which takes two switches of threads for each tick.
        """
        if _has_running_loop():
            self._wait_beside(seconds)
            return
        self._borrow()
        if self._calls:
            self._do_posted()
        if self._woken:
            self._loop.stop()  # one iteration: send the posted data, read the received data
        elif self._alarm is None:
            # an earlier timer, if there is one, is sufficient
            self._alarm = self._loop.call_later(seconds, self._ring)
        begin = perf_counter()
        if self._watchful:
            self._selector.until = begin + _WATCH
        self._loop.run_forever()
        if self._unread:
            functions, self._unread = self._unread, []
            self._after_reading(functions)
        self._woken = False
        self._last_service = perf_counter()
        self._watchful = self._last_service - begin < _WATCH

    def _wait_beside(self, seconds: float) -> None:
        """Wait while the network thread serves the clients: in a thread with a loop, no other loop can run."""
        self.give_back()
        if not self._woken:
            self._awakened.wait(seconds)
        self._awakened.clear()
        self._woken = False
        self._waits_beside, self._last_service = True, perf_counter()

    def _do_posted(self) -> None:
        # called here, because the loop would need another iteration
        calls, self._calls = self._calls, []
        for function, args in calls:
            try:
                function(*args)
            except Exception as error:  # as asyncio does for callbacks
                self._loop.call_exception_handler({"message": f"error in {function}", "exception": error})

    def wake(self) -> None:
        """End `wait`, now or as soon as it is called; may be called from any thread."""
        self._woken = True
        if self._borrower == threading.get_ident():
            if self._loop.is_running():
                self._loop.stop()
        elif self._borrower is not None:
            self._loop.call_soon_threadsafe(self._loop.stop)
        else:
            self._awakened.set()

    def tend(self) -> None:
        """Return a borrowed loop if it has not been run for some time; to be called between ticks."""
        if self.is_awaited and perf_counter() - self._last_service > _UNSERVED:
            self._waits_beside = False
            self.give_back()

    def give_back(self) -> None:
        """Return a borrowed loop to the network thread."""
        if self._borrower == threading.get_ident():
            self._borrower = None
            calls, self._calls = self._calls, []
            for function, args in calls:
                self._loop.call_soon(function, *args)
            self._asked_for = False
            self._go_on.set()

    def _borrow(self) -> None:
        if self._borrower is None:
            self._asked_for = True
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._is_parked.wait()
            self._is_parked.clear()
            self._borrower = threading.get_ident()

    def _ring(self) -> None:
        self._alarm = None
        if self._borrower is not None:
            self._loop.stop()

    def stop(self) -> None:
        """Cancel all tasks, close the loop and wait for the thread."""
        self.give_back()
        if self._thread.is_alive():
            self._ending = True
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(timeout=5.0)
