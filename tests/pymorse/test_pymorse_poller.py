"""The thread that serves connections, and waiting threads that serve them in its place."""

import threading

import pytest

import pymorse.poller
from pymorse.poller import Poller


@pytest.mark.parametrize("courtesy", [0.0, 1e-6, 1e-4])
def test_a_guest_whom_the_system_lets_wait_is_served_all_the_same(
    courtesy: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # with such a short grace period, it has expired when the thread checks for a waiting thread, as on a loaded machine
    monkeypatch.setattr(pymorse.poller, "_COURTESY", courtesy)
    poller = Poller()
    poller.start()

    def call_often() -> None:
        for _ in range(3000):
            poller.catch_up()

    guest = threading.Thread(target=call_often, daemon=True)
    guest.start()
    guest.join(60.0)
    assert not guest.is_alive()
    poller.syncstop(5.0)
    assert not poller.is_alive()


class _Turn:
    """A turn for which the thread has to wait until a guest has obeyed the command to stop."""

    def __init__(self, poller: Poller) -> None:
        self._poller = poller

    def __enter__(self) -> None:
        self._poller._stopping = True

    def __exit__(self, *_: object) -> None: ...


def test_the_thread_ends_if_a_guest_was_told_to_stop() -> None:
    poller = Poller()
    poller._turn = _Turn(poller)  # type: ignore[assignment]
    poller.start()
    poller.join(60.0)
    assert not poller.is_alive()
