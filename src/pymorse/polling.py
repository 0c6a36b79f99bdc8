"""Threads for streams that programs create themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pymorse.poller import Poller

if TYPE_CHECKING:
    from types import TracebackType


class PollThread(Poller):
    """A thread that serves every stream created while it runs.

    Streams that are created while no such thread runs have their own thread. Use it as a context manager::

        with PollThread():
            stream = StreamJSON("localhost", 60000)

    Args:
        timeout: exists for programs written for 1.4; the thread has no period.
    """

    def __init__(self, timeout: float = 0.01) -> None:
        super().__init__("pymorse-poll")
        self.timeout = timeout

    def start(self) -> None:
        """Start serving."""
        super().start()
        _public.append(self)

    def syncstop(self, timeout: float | None = None) -> None:
        """Close all streams, and wait until the thread has ended, at most ``timeout`` seconds."""
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
    """The latest running `PollThread`, or a new thread that ends with its last stream."""
    while _public:
        if _public[-1].is_alive():
            return _public[-1]
        _public.pop()
    poller = Poller("pymorse-stream", until_empty=True)
    poller.start()
    return poller
