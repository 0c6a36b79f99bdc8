from collections.abc import Iterator

import pytest
from socket_bench import Bench, Peer


@pytest.fixture(autouse=True)
def _free_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")


@pytest.fixture(autouse=True)
def _long_periods(monkeypatch: pytest.MonkeyPatch) -> None:
    """A complaint is repeated after ten seconds, in which a busy machine may not reach the end of a test."""
    monkeypatch.setattr("morse.core.clients.complaints._PERIOD", 1e9)


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.close()


@pytest.fixture
def client(bench: Bench) -> Iterator[Peer]:
    peer = bench.connect()
    yield peer
    peer.close()
