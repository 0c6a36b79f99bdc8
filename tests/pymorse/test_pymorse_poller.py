"""The thread that serves connections, and waiting threads that serve them in its place."""

from __future__ import annotations

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
