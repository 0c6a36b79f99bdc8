"""A server that sends without end leaves time for the other connections of a client."""

import contextlib
import socket
import time

from pymorse.poller import Poller
from pymorse.stream import StreamB

MANY = 1 << 20


def test_messages_that_take_long_are_read_in_small_chunks() -> None:
    sizes: list[int] = []

    class Slow(StreamB):
        def received(self, data: bytes) -> None:
            sizes.append(len(data))
            time.sleep(0.01)

    server, client = socket.socketpair()
    with server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MANY)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, MANY)
        server.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            sent = server.send(b"1\n" * MANY)
        assert sent > 1 << 17
        poller = Poller(until_empty=True)
        stream = Slow(sock=client, poller=poller)
        poller.start()
        end = time.monotonic() + 60.0
        while sum(sizes) < sent:
            assert time.monotonic() < end
            time.sleep(0.01)
        stream.close()
    # 131,072 messages at once kept the other sockets waiting for more than a second
    assert max(sizes) <= 1 << 14
