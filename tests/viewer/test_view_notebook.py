"""The page in a frame of a notebook."""

import contextlib
import socket
import threading
from html.parser import HTMLParser

import pytest
from view_pages import fetch, port_of
from view_simulation import CircleDriver
from view_worlds import playground

from morse.viewer.notebook import Frame, frame, proxy_token
from morse.viewer.server import ViewServer
from tests.kit.notebooks import run_cells
from tests.kit.waiting import wait_until


def attributes(html: str) -> dict[str, str | None]:
    found: list[tuple[str, dict[str, str | None]]] = []
    parser = HTMLParser()
    parser.handle_starttag = lambda tag, given: found.append((tag, dict(given)))  # type: ignore[method-assign]
    parser.feed(html)
    tag, given = found[0]
    assert tag == "iframe"
    return given


def test_the_frame_shows_the_address_at_the_height_asked_for() -> None:
    given = attributes(frame("http://127.0.0.1:8765/?token=a%26b&x=1", 300)._repr_html_())
    assert given["src"] == "http://127.0.0.1:8765/?token=a%26b&x=1"
    assert given["height"] == "300"


def test_an_address_cannot_break_out_of_the_frame() -> None:
    url = 'http://x/"><script>alert(1)</script>'
    assert attributes(frame(url)._repr_html_())["src"] == url


@pytest.mark.parametrize(
    ("url", "height"), [("javascript:alert(1)", 300), ("", 300), ("http://x/", 5), ("http://x/", 1e9)]
)
def test_what_is_no_page_is_refused(url: str, height: int) -> None:
    with pytest.raises(ValueError, match=r"expected the address|the height of a frame"):
        frame(url, height)


def test_notebooks_of_this_machine_may_frame_the_page_and_others_may_not(served) -> None:
    _, url = served
    policy = fetch(url)[1]["Content-Security-Policy"]
    (ancestors,) = [rule.strip() for rule in policy.split(";") if "frame-ancestors" in rule]
    assert ancestors.split()[1:] == ["'self'", "http://localhost:*", "http://127.0.0.1:*"]


@pytest.mark.browser
def test_the_page_runs_within_a_frame(running, make_server, open_page) -> None:
    _, url = running
    page = open_page(url)
    page.evaluate("""html => { document.body.innerHTML = html }""", frame(url + "?quality=low", 300)._repr_html_())
    framed = page.frame_locator("iframe")
    framed.locator('[data-name="robot0"]').wait_for(state="attached", timeout=60_000)
    framed.locator("canvas").first.wait_for(timeout=60_000)


@pytest.mark.parametrize(
    ("variables", "address", "note"),
    [
        ({"JUPYTERHUB_SERVICE_PREFIX": "/user/ada/"}, "/user/ada/proxy/8765/?token=t", "jupyter-server-proxy"),
        ({"VSCODE_PROXY_URI": "https://x.org/proxy/{{port}}"}, "https://x.org/proxy/8765/?token=t", "open https://x"),
        ({"TERM_PROGRAM": "vscode"}, "http://127.0.0.1:8765/?token=t", "port 8765"),
        ({}, "http://127.0.0.1:8765/?token=t", ""),
    ],
)
def test_the_frame_has_the_address_of_the_proxy(
    monkeypatch: pytest.MonkeyPatch, variables: dict[str, str], address: str, note: str
) -> None:
    for name in ("JUPYTERHUB_SERVICE_PREFIX", "VSCODE_PROXY_URI", "VSCODE_PID", "TERM_PROGRAM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    shown = frame("http://127.0.0.1:8765/?token=t")
    assert attributes(shown._repr_html_())["src"] == address
    assert note in shown.note
    assert bool(note) == ("small" in shown._repr_html_())
    assert (proxy_token() is None) == ("http://127" in address)


def test_the_notebook_of_the_examples_shows_drives_and_measures(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    values, shown = run_cells("live_view.ipynb", duration="0.6")
    page = next(value for value in shown if isinstance(value, Frame))
    assert attributes(page._repr_html_())["src"].startswith("http://127.0.0.1:")
    assert sorted(values["speed"])[len(values["speed"]) // 2] == pytest.approx(1.0, rel=0.02)
    # both cells that run
    assert values["track"][-1][0] == pytest.approx(1.2, abs=0.05)


class Proxy:
    """Shows a port of this machine in a folder, under another host name, as the proxies of notebook servers do."""

    def __init__(self, folder: str, port: int) -> None:
        self._folder, self._target = folder.encode(), port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        self._listener.close()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                threading.Thread(target=self._serve, args=(client,), daemon=True).start()

    def _serve(self, client: socket.socket) -> None:
        with contextlib.suppress(OSError), client:
            head = b""
            while b"\r\n\r\n" not in head:
                if not (data := client.recv(4096)):
                    return
                head += data
            method, path, rest = head.split(b" ", 2)
            if not path.startswith(self._folder):
                client.sendall(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")
                return
            rest = rest.replace(b"127.0.0.1:%d" % self.port, b"hub.example.org")
            with socket.create_connection(("127.0.0.1", self._target)) as server:
                server.sendall(b" ".join([method, b"/" + path.removeprefix(self._folder), rest]))
                back = threading.Thread(target=_pass_on, args=(server, client), daemon=True)
                back.start()
                _pass_on(client, server)
                back.join()


def _pass_on(source: socket.socket, target: socket.socket) -> None:
    with contextlib.suppress(OSError):
        while data := source.recv(65536):
            target.sendall(data)
    with contextlib.suppress(OSError):
        target.shutdown(socket.SHUT_WR)


def test_the_page_runs_in_a_folder_of_a_proxy(network, open_page) -> None:
    server = ViewServer(network, port=0, token="secret")
    port = port_of(server.start())
    scene, moving = playground()
    server.set_scene(scene, moving)
    proxy = Proxy("/user/ada/proxy/1234/", port)
    try:
        with CircleDriver(server, moving):
            page = open_page(f"http://127.0.0.1:{proxy.port}/user/ada/proxy/1234/?token=secret")
            assert page.evaluate("morse.stage.world.nodes.length") > 3
            wait_until(lambda: page.evaluate("morse.poses.value !== null"), "poses through the proxy")
    finally:
        proxy.close()
        server.stop()
