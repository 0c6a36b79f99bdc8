"""Where all network traffic lives: one event loop, served by one thread at a time."""

from __future__ import annotations

import asyncio
import os
import selectors
import threading
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Coroutine

_T = TypeVar("_T")

#: wall-clock seconds for which a loop that is borrowed may stay unserved
_UNSERVED = 0.002
#: wall-clock seconds: a thread whose last wait was shorter polls for that time before it sleeps; a wake-up takes longer
#: than a tick
_WATCH = 0.0002 if (os.cpu_count() or 1) > 1 else 0.0


class _WatchfulSelector(selectors.DefaultSelector):
    """Looks for events for a while before it sleeps.

    Attributes:
        until: looks until then (`time.perf_counter`).
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


class Network:
    """An asyncio loop in a daemon thread.

    The simulation thread hands work over with `post`, which never blocks; only start-up and
    shut-down wait for an answer (`call`).

    A simulation that waits for its clients borrows the loop: `wait` serves it from the thread that
    waits. What arrives, the tick that it asks for and the answer then stay in one thread; two changes
    of threads would take longer than the tick. The loop stays borrowed until `give_back` or `tend`.
    """

    def __init__(self) -> None:
        self._selector = _WatchfulSelector()
        self._loop = asyncio.SelectorEventLoop(self._selector)
        self._thread = threading.Thread(target=self._serve, name="morse-network", daemon=True)
        self._parked, self._go_on = threading.Event(), threading.Event()
        self._asked_for = self._ending = self._woken = False
        self._borrower: int | None = None
        self._served = 0.0
        self._first: dict[int, Callable[[], object]] = {}
        self._unread: list[Callable[[], object]] = []
        self._posted: list[tuple[Callable[..., object], tuple[Any, ...]]] = []
        self._alarm: asyncio.TimerHandle | None = None
        self._watchful = False
        self._thread.start()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            while not self._ending:
                self._loop.run_forever()
                if self._asked_for:
                    self._parked.set()
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
        """The event loop; use it from within its callbacks only."""
        return self._loop

    def post(self, function: Callable[..., object], *args: Any) -> None:
        """Have ``function(*args)`` run by who serves the loop, soon; silently too late after `stop`.

        It may write to connections and schedule callbacks, but not count on a loop that runs.
        """
        if self._borrower == threading.get_ident():
            self._posted.append((function, args))
            return
        try:
            self._loop.call_soon_threadsafe(function, *args)
        except RuntimeError:
            if not self._loop.is_closed():
                raise

    def call(self, coroutine: Coroutine[Any, Any, _T], timeout: float = 10.0) -> _T:
        """Run a coroutine in the network thread and wait for its result.

        Raises:
            TimeoutError: if it takes longer than ``timeout`` seconds of wall-clock time.
        """
        self.give_back()
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(timeout)

    # -- what arrives, and in which order ----------------------------------------------------

    def on_readable(self, sock: socket.socket, function: Callable[[], object], *, comes_first: bool = False) -> None:
        """Call ``function`` whenever there is something to take from ``sock``; to be called in the loop.

        Args:
            comes_first: `when_read` takes what is there, too. ``function`` must not block, and may be called when
                there is nothing.
        """
        self._loop.add_reader(sock, function)
        if comes_first:
            self._first[sock.fileno()] = function

    def ignore(self, sock: socket.socket) -> None:
        """Take nothing from ``sock`` any more; to be called before it is closed."""
        self._loop.remove_reader(sock)
        self._first.pop(sock.fileno(), None)

    def when_read(self, function: Callable[[], object]) -> None:
        """Run ``function()`` when all that has arrived by now is read; to be called in the loop.

        The loop reads connections in any order. A client that sends a command on one and then asks for a tick on
        another means the tick to see the command. The system puts what is sent first into the buffers first, so that
        one look at all sockets after the request has been read finds the command.
        """
        if self._borrower is None:
            self._loop.call_soon(self._after_reading, [function])
        else:
            self._unread.append(function)
            self._loop.stop()

    def _after_reading(self, functions: list[Callable[[], object]]) -> None:
        if self._first:
            for key, _ in self._selector.ready():
                read = self._first.get(key.fd)
                if read is not None:
                    read()
        for function in functions:
            function()

    # -- the loop in the thread that waits ---------------------------------------------------

    def wait(self, seconds: float) -> None:
        """Serve the network from this thread until `wake` is called, at most for about ``seconds``.

        What was posted before is done first. Between two calls nothing is received or sent.
        """
        self._borrow()
        if self._posted:
            self._do_posted()
        if self._woken:
            self._loop.stop()  # one round: send what was posted, take what is there
        elif self._alarm is None:
            # one that was set before will do: it rings earlier
            self._alarm = self._loop.call_later(seconds, self._ring)
        begin = perf_counter()
        if self._watchful:
            self._selector.until = begin + _WATCH
        self._run()
        if self._unread:
            functions, self._unread = self._unread, []
            self._after_reading(functions)
        self._woken = False
        self._served = perf_counter()
        self._watchful = self._served - begin < _WATCH

    def _run(self) -> None:
        # a notebook's cell, or a coroutine, waits within the loop of its own thread: that one pauses meanwhile
        outer = asyncio._get_running_loop()
        if outer is None:
            self._loop.run_forever()
            return
        asyncio._set_running_loop(None)
        try:
            self._loop.run_forever()
        finally:
            asyncio._set_running_loop(outer)

    def _do_posted(self) -> None:
        # here, not in the loop: that would take a round of its own
        posted, self._posted = self._posted, []
        for function, args in posted:
            try:
                function(*args)
            except Exception as error:  # as the loop would do
                self._loop.call_exception_handler({"message": f"error in {function}", "exception": error})

    def wake(self) -> None:
        """End `wait`, now or as soon as it is called; may be called from any thread."""
        self._woken = True
        if self._borrower == threading.get_ident():
            if self._loop.is_running():
                self._loop.stop()
        elif self._borrower is not None:
            self._loop.call_soon_threadsafe(self._loop.stop)

    def tend(self) -> None:
        """Give a borrowed loop back if nobody has served it for a while; to be called between ticks."""
        if self._borrower is not None and perf_counter() - self._served > _UNSERVED:
            self.give_back()

    def give_back(self) -> None:
        """Let the network thread serve again, if this one has borrowed its loop."""
        if self._borrower == threading.get_ident():
            self._borrower = None
            posted, self._posted = self._posted, []
            for function, args in posted:
                self._loop.call_soon(function, *args)
            self._asked_for = False
            self._go_on.set()

    def _borrow(self) -> None:
        if self._borrower is None:
            self._asked_for = True
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._parked.wait()
            self._parked.clear()
            self._borrower = threading.get_ident()

    def _ring(self) -> None:
        self._alarm = None
        if self._borrower is not None:
            self._loop.stop()

    def stop(self) -> None:
        """Cancel what runs, close the loop and wait for the thread."""
        self.give_back()
        if self._thread.is_alive():
            self._ending = True
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(timeout=5.0)
