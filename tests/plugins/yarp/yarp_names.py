"""A name server for tests: the requests and answers of the documentation of YARP, on 127.0.0.1."""

import socketserver
import threading


class Names:
    """Knows the addresses of ports.

    Attributes:
        known: host and number of the TCP port of each name.
        requests: the requests that arrived.
    """

    def __init__(self, port: int = 0) -> None:
        self.known: dict[str, tuple[str, int]] = {}
        self.requests: list[str] = []
        names = self

        class Handler(socketserver.StreamRequestHandler):
            def handle(self) -> None:
                line = self.rfile.readline().decode().split()
                names.requests.append(" ".join(line))
                self.wfile.write(f"{names.answer(line)}*** end of message\n".encode())

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address = True
            daemon_threads = True

        self._server = Server(("127.0.0.1", port), Handler)
        self.port = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True).start()

    def answer(self, words: list[str]) -> str:
        if words[:1] != ["NAME_SERVER"] or len(words) < 3:
            return "unknown command\n"
        command, name = words[1:3]
        if command == "register":
            self.known[name] = (words[4], int(words[5]))
        if command == "unregister":
            self.known.pop(name, None)
        if name not in self.known:
            return ""
        host, number = self.known[name]
        return f"registration name {name} ip {host} port {number} type tcp\n"

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()
