"""Many connections to a port of YARP."""

import asyncio
from types import SimpleNamespace

import pytest

from morse.core.clients.budgets import Arrivals
from morse.plugins.yarp.port import Port
from morse.wire.listener import listen, port_of
from tests.kit.waiting import run_apart


def test_connections_that_do_not_speak_have_a_limit(caplog: pytest.LogCaptureFixture) -> None:
    async def crowd() -> bytes:
        port = Port("/robot/pose/out", SimpleNamespace(), None, Arrivals())  # type: ignore[arg-type] # it asks for no names
        listener = listen("127.0.0.1", (0,))
        number = port_of(listener)
        await port.open(listener)
        async with asyncio.timeout(60.0):
            peers = [await asyncio.open_connection("127.0.0.1", number) for _ in range(65)]
            refused = await peers[0][0].read()
            for _, writer in peers:
                writer.close()
        await port.close()
        return refused

    assert run_apart(crowd()) == b""
    assert "to make room" in caplog.text
