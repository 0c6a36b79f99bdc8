"""The threads that move bytes between sockets and their owners."""

from __future__ import annotations

import contextlib
import logging
import selectors
import socket
import threading
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from pymorse.channel import Channel

logger = logging.getLogger("pymorse")

_READ, _WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE


def _nothing() -> None: ...


class Poller(threading.Thread):
    """Serves channels from a thread of its own, which sleeps until something arrives.

    Args:
        name: of the thread.
        until_empty: end when the last channel has been closed.
    """

    def __init__(self, name: str = "pymorse", *, until_empty: bool = False) -> None:
        super().__init__(name=name, daemon=True)
        self._until_empty = until_empty
        self._selector = selectors.DefaultSelector()
        self._channels: set[Channel] = set()
        self._commands: deque[Callable[[], object]] = deque()
        self._lock = threading.Lock()
        self._stopping = False
        self._ended = False
        self._wake_out, self._wake_in = socket.socketpair()
        self._wake_out.setblocking(False)
        self._wake_in.setblocking(False)
        self._selector.register(self._wake_out, _READ, None)

    def command(self, function: Callable[[], object]) -> bool:
        """Have ``function()`` run in the thread soon; False if the thread has ended."""
        with self._lock:
            if self._ended:
                return False
            self._commands.append(function)
            with contextlib.suppress(BlockingIOError):  # it is about to wake up anyway
                self._wake_in.send(b"\0")
        return True

    def call(self, function: Callable[[], object]) -> None:
        """Run ``function()`` in the thread, and return when it is done."""
        done = threading.Event()

        def run() -> None:
            try:
                function()
            finally:
                done.set()

        if threading.current_thread() is self or not self.is_alive() or not self.command(run):
            function()
            return
        while not done.wait(0.5):  # short waits let Ctrl+C through on every platform
            if not self.is_alive():
                return

    def catch_up(self) -> None:
        """Return when everything that had arrived at the time of the call has been handled."""
        # the round that runs may have begun before something arrived: the next one has not
        self.call(_nothing)
        self.call(_nothing)

    def add(self, channel: Channel) -> None:
        """Serve a channel from now on."""

        def register() -> None:
            self._channels.add(channel)
            self._selector.register(channel.socket, _READ, channel)

        if not self.command(register):
            raise RuntimeError("the poll thread has been stopped: create the stream before syncstop()")

    def remove(self, channel: Channel) -> None:
        """Serve a channel no longer; runs in the thread."""
        if channel in self._channels:
            self._channels.discard(channel)
            self._selector.unregister(channel.socket)
            if self._until_empty and not self._channels:
                self._finish()

    def watch_writable(self, channel: Channel, wanted: bool) -> None:
        """Say whether a channel has bytes to send; runs in the thread."""
        if channel in self._channels:
            self._selector.modify(channel.socket, _READ | _WRITE if wanted else _READ, channel)

    def run(self) -> None:
        """Serve until stopped."""
        try:
            while not self._stopping:
                wakened = False
                for key, events in self._selector.select():
                    if key.data is None:
                        wakened = True
                    else:
                        self._serve(key.data, events)
                if wakened:
                    self._obey()
        finally:
            self._end()

    def _serve(self, channel: Channel, events: int) -> None:
        try:
            if events & _WRITE and channel in self._channels:
                channel.writable()
            if events & _READ and channel in self._channels:
                channel.readable()
        except Exception:
            logger.exception("the connection to %s is closed because of an error", channel.peer)
            channel.close()

    def _obey(self) -> None:
        with self._lock:
            with contextlib.suppress(BlockingIOError):
                self._wake_out.recv(4096)
            commands = list(self._commands)
            self._commands.clear()
        for command in commands:
            command()

    def _end(self) -> None:
        with self._lock:
            self._ended = True
        while self._commands:
            self._commands.popleft()()
        for channel in list(self._channels):
            channel.close()
        self._selector.close()
        self._wake_in.close()
        self._wake_out.close()

    def syncstop(self, timeout: float | None = None) -> None:
        """Close every channel, end the thread and wait for that, at most ``timeout`` seconds."""
        if not self.is_alive():
            if not self._ended:
                self._end()
            return
        self.command(self._finish)
        if threading.current_thread() is not self:
            self.join(timeout)

    def _finish(self) -> None:
        self._stopping = True


class PollThread(Poller):
    """A thread that serves every stream made while it runs.

    Streams made while no such thread runs bring their own. Use it as a context::

        with PollThread():
            stream = StreamJSON("localhost", 60000)

    Args:
        timeout: kept for programs written for 1.4; the thread needs no period.
    """

    def __init__(self, timeout: float = 0.01) -> None:
        super().__init__("pymorse-poll")
        self.timeout = timeout

    def start(self) -> None:
        """Start serving."""
        super().start()
        _public.append(self)

    def syncstop(self, timeout: float | None = None) -> None:
        """Close every stream, end the thread and wait for that, at most ``timeout`` seconds."""
        if self in _public:
            _public.remove(self)
        super().syncstop(timeout)

    def __enter__(self) -> PollThread:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.syncstop()


_public: list[PollThread] = []


def default_poller() -> Poller:
    """The latest `PollThread` that runs, or a new thread that ends with its last stream."""
    while _public:
        if _public[-1].is_alive():
            return _public[-1]
        _public.pop()
    poller = Poller("pymorse-stream", until_empty=True)
    poller.start()
    return poller
