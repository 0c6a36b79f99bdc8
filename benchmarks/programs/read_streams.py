"""Connects several times to every given port and reads the data: ``read_streams CLIENTS PORT...``."""

from __future__ import annotations

import selectors
import socket
import sys


def main() -> None:
    """Read until killed."""
    clients, *ports = (int(argument) for argument in sys.argv[1:])
    selector = selectors.DefaultSelector()
    for _ in range(clients):
        for port in ports:
            connection = socket.create_connection(("127.0.0.1", port))
            connection.setblocking(False)
            selector.register(connection, selectors.EVENT_READ)
    print("connected", flush=True)
    while selector.get_map():
        for key, _ in selector.select():
            assert isinstance(key.fileobj, socket.socket)
            if not key.fileobj.recv(1 << 20):
                selector.unregister(key.fileobj)


if __name__ == "__main__":
    main()
