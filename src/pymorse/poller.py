"""A thread that moves bytes between sockets and their owners."""

from __future__ import annotations

import contextlib
import logging
import os
import selectors
import socket
import threading
import time
from typing import TYPE_CHECKING

from pymorse.messages import Arrivals

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pymorse.channel import Channel

logger = logging.getLogger("pymorse")

_READ, _WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE
#: time for which the thread waits after a guest has left, s, because another guest often follows
_COURTESY = 0.005
#: interval at which a guest tries to wake up the sleeping thread, s
_AGAIN = 0.005
#: time for which a guest polls before it sleeps, s, if its last wait was shorter than that
_WATCH = 0.0002 if (os.cpu_count() or 1) > 1 else 0.0
#: number of times that all sockets are read before callers are woken up: while some are read, others become readable
_SWEEPS = 4


def _nothing() -> None: ...


class Poller(threading.Thread):
    """Serves channels from a separate thread, which sleeps until data arrive.

    A thread that waits for an answer may serve the channels itself in the meantime, as a guest
    (`serve_until`), because a thread switch takes longer than most answers.

    Args:
        name: name of the thread.
        until_empty: whether to end when the last channel has been closed.

    Attributes:
        arrivals: messages that have been received and are not shown to callers yet.
    """

    def __init__(self, name: str = "pymorse", *, until_empty: bool = False) -> None:
        super().__init__(name=name, daemon=True)
        self._until_empty = until_empty
        self.arrivals = Arrivals()
        self._selector = selectors.DefaultSelector()
        self._channels: set[Channel] = set()
        self._commands: list[Callable[[], object]] = []
        self._lock = threading.Lock()
        self._stopping = False
        self._ended = False
        self._wake_out, self._wake_in = socket.socketpair()
        self._wake_out.setblocking(False)
        self._wake_in.setblocking(False)
        self._selector.register(self._wake_out, _READ, None)
        # lock of the serving thread; only one guest at a time
        self._turn = threading.Lock()
        self._serving = 0
        self._guest = threading.Lock()
        self._standing_back = threading.Condition()
        self._until = 0.0
        self._watchful = True

    def is_serving(self) -> bool:
        """Whether the calling thread is the serving thread."""
        return self._serving == threading.get_ident()

    # -- commands ----------------------------------------------------------------------------

    def command(self, function: Callable[[], object]) -> bool:
        """Schedule ``function()`` in the serving thread; return False if the thread has ended."""
        with self._lock:
            if self._ended:
                return False
            self._commands.append(function)
            self._wake()
        self._return()
        return True

    def _wake(self) -> None:
        with contextlib.suppress(BlockingIOError):  # the thread is about to wake up anyway
            self._wake_in.send(b"\0")

    def call(self, function: Callable[[], object]) -> None:
        """Run ``function()`` in the serving thread, and return when it is done."""
        done = threading.Event()

        def run() -> None:
            try:
                function()
            finally:
                done.set()

        if self.is_serving() or not self.is_alive() or not self.command(run):
            function()
            return
        while not done.wait(0.5):  # with short waits, Ctrl+C is processed on every platform
            if not self.is_alive():
                return

    def catch_up(self) -> None:
        """Return when all data that had arrived at the time of the call have been processed."""
        if self.is_serving() or self._serve_as_guest(lambda: True, 0.0):
            return
        # the present round may have begun before the data arrived; the next one has not
        self.call(_nothing)
        self.call(_nothing)

    # -- channels; all but `add` are called in the serving thread --------------------------

    def add(self, channel: Channel) -> None:
        """Add a channel."""

        def register() -> None:
            self._channels.add(channel)
            self._selector.register(channel.socket, _READ, channel)

        if not self.command(register):
            raise RuntimeError("the poll thread has been stopped: create the stream before syncstop()")

    def remove(self, channel: Channel) -> None:
        """Remove a channel."""
        if channel in self._channels:
            self._channels.discard(channel)
            self._selector.unregister(channel.socket)
            self.arrivals.show(everything=True)  # what it would still have received is not missed
            if self._until_empty and not self._channels:
                self._finish()

    def watch_writable(self, channel: Channel, wanted: bool) -> None:
        """Set whether a channel has bytes to send."""
        if channel in self._channels:
            self._selector.modify(channel.socket, _READ | _WRITE if wanted else _READ, channel)

    # -- serving -----------------------------------------------------------------------------

    def run(self) -> None:
        """Serve until stopped."""
        try:
            while not self._stopping:
                with self._turn:
                    # A guest that arrived in the meantime has found no thread to wake up. A guest that had the turn
                    # may have obeyed the command to stop, which nobody repeats
                    if not self._stopping and not self._has_guest():
                        self._round(None)
                self._stand_back()
        finally:
            self._end()

    def serve_until(self, done: Callable[[], bool], timeout: float) -> bool:
        """Serve from the calling thread until ``done()``, at most ``timeout`` seconds.

        Returns:
            False immediately if another thread is already serving, or if the poller does not run.
        """
        return not self.is_serving() and self._serve_as_guest(done, timeout)

    def _serve_as_guest(self, done: Callable[[], bool], timeout: float) -> bool:
        if self._stopping or not self.is_alive() or not self._guest.acquire(blocking=False):
            return False
        deadline = time.monotonic() + timeout
        try:
            self._until = deadline + _COURTESY
            if not self._take_turn():
                return False
            try:
                if timeout <= 0.0:
                    self._round(0.0)
                while not (done() or self._stopping) and (left := deadline - time.monotonic()) > 0.0:
                    self._round(left, watch=True)
            finally:
                self._turn.release()
            self._until = time.monotonic() + _COURTESY
        finally:
            self._guest.release()
        if self._stopping:
            self._return()
        return True

    def _take_turn(self) -> bool:
        # If the operating system delays a guest for longer than this courtesy time, the guest finds the thread asleep,
        # although it was not serving when the guest arrived. It is woken up until the guest has the lock.
        while not self._turn.acquire(blocking=False):
            with self._lock:
                if self._ended:
                    return False
                self._wake()
            if self._turn.acquire(timeout=_AGAIN):
                return True
        return True

    def _stand_back(self) -> None:
        with self._standing_back:
            while not self._stopping and self._has_guest():
                # short sleeps, so that a guest that leaves early does not have to wake up the thread
                self._standing_back.wait(_COURTESY)

    def _has_guest(self) -> bool:
        return not self._commands and time.monotonic() < self._until

    def _return(self) -> None:
        with self._standing_back:
            self._standing_back.notify_all()

    def _round(self, timeout: float | None, watch: bool = False) -> None:
        if self._ended:
            return
        self._serving = threading.get_ident()
        try:
            patience = self.arrivals.patience
            if patience is not None:
                timeout = patience if timeout is None else min(timeout, patience)
            wakened = self._serve_all(self._watch(timeout) if watch else self._selector.select(timeout))
            sweeps = 1
            while sweeps < _SWEEPS and len(self.arrivals) and len(self._channels) > 1 and not wakened:
                ready = self._selector.select(0.0)
                sweeps = sweeps + 1 if ready else _SWEEPS
                wakened = self._serve_all(ready)
            self.arrivals.show()
            if wakened:
                self._obey()
        finally:
            self._serving = 0

    def _serve_all(self, ready: Iterable[tuple[selectors.SelectorKey, int]]) -> bool:
        """Serve the channels that are ready; return whether there are commands."""
        wakened = False
        for key, events in ready:
            if key.data is None:
                wakened = True
            else:
                self._serve(key.data, events)
        return wakened

    def _watch(self, timeout: float | None) -> list[tuple[selectors.SelectorKey, int]]:
        """The sockets that are ready; polls briefly, because waking a thread up takes longer than most answers."""
        begin = now = time.perf_counter()
        ready: list[tuple[selectors.SelectorKey, int]] = []
        while self._watchful and now < begin + _WATCH and not ready:
            ready = self._selector.select(0.0)
            now = time.perf_counter()
        ready = ready or self._selector.select(timeout)
        self._watchful = time.perf_counter() < begin + _WATCH
        return ready

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
            commands, self._commands = self._commands, []
        for command in commands:
            command()

    # -- the end -----------------------------------------------------------------------------

    def _finish(self) -> None:
        self._stopping = True

    def _end(self) -> None:
        with self._turn:
            with self._lock:
                self._ended = True
            for command in self._commands:
                command()
            self._serving = threading.get_ident()
            for channel in list(self._channels):
                channel.close()
            self.arrivals.show(everything=True)
            self._serving = 0
            self._selector.close()
            self._wake_in.close()
            self._wake_out.close()

    def syncstop(self, timeout: float | None = None) -> None:
        """Close all channels, and wait until the thread has ended, at most ``timeout`` seconds."""
        if not self.is_alive():
            if not self._ended:
                self._end()
            return
        self.command(self._finish)
        if not self.is_serving():
            self.join(timeout)
