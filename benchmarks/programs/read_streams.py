"""Clients that read the data: ``read_streams CLIENTS PORT...``, or ``read_streams CLIENTS --binary PORT NAME...``.

The first form connects to every given port, the second subscribes to the binary streams of these names.
"""

from __future__ import annotations

import selectors
import socket
import sys


def main() -> None:
    """Read until killed."""
    clients, *words = sys.argv[1:]
    binary = words[0] == "--binary"
    ports, names = (words[1:2], words[2:]) if binary else (words, [])
    requests = "".join(f"subscribe {name}\n" for name in names).encode()
    selector = selectors.DefaultSelector()
    for _ in range(int(clients)):
        for port in ports:
            connection = socket.create_connection(("127.0.0.1", int(port)))
            connection.sendall(requests)
            if binary:
                connection.recv(1)  # the simulation knows the reader
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
