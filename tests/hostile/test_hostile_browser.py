"""A browser that shows a page from elsewhere: another origin, a frame, and a name that was made to point here."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

import pytest
from limited import Run, call, limited_run

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(Pose('pose'))
robot.append(MotionVW('motion'))
for interface in ('socket', 'rosbridge', 'foxglove'):
    robot.add_default_interface(interface)
env = Environment('empty')
for manager in ('rosbridge', 'foxglove'):
    env.configure_stream_manager(manager, port=0)
"""
#: names of pages of others; the first one resolves to this machine
EVIL = "evil.example"
#: tries everything that a page can do with a port of this machine, and tells what it has read
ATTACK = """
async ([host, ports, lines]) => {
    const told = [];
    const limited = (promise) => Promise.race([promise, new Promise((done) => setTimeout(done, 1000, "nothing"))]);
    await Promise.all(ports.map(async (port) => {
        const place = `${host}:${port}`;
        const sockets = (async () => {
            for (const path of ["/ws", "/"])
                for (const protocols of [[], ["foxglove.sdk.v1"], ["foxglove.websocket.v1"]]) {
                    const socket = new WebSocket(`ws://${place}${path}`, protocols);
                    const opened = await limited(new Promise((done) => {
                        socket.onopen = () => done("opened");
                        socket.onerror = socket.onclose = () => done("refused");
                    }));
                    if (opened === "opened") {
                        told.push(`WebSocket ${place}${path} ${protocols}`);
                        socket.send(lines);
                    }
                    socket.close();
                }
        })();
        for (const mode of ["cors", "no-cors"]) {
            for (const path of ["/", "/worlds/1.json"]) {
                const answer = await limited(fetch(`http://${place}${path}`, { mode }).catch((error) => null));
                const text = answer?.text ? await answer.text().catch(() => "") : "";
                if (text.length && answer.ok) told.push(`${mode} ${place}${path}: ${text.slice(0, 40)}`);
            }
            await limited(fetch(`http://${place}/`, { method: "POST", mode, body: lines }).catch(() => null));
        }
        const beacon = navigator.sendBeacon(`http://${place}/`, lines);
        const image = new Image();
        const shown = await limited(new Promise((done) => {
            image.onload = () => done("loaded");
            image.onerror = () => done("refused");
            image.src = `http://${place}/favicon.svg`;
        }));
        if (shown === "loaded") told.push(`image ${place}`);
        const script = document.createElement("script");
        const ran = await limited(new Promise((done) => {
            script.onload = () => done("loaded");
            script.onerror = () => done("refused");
            script.src = `http://${place}/worlds/1.json`;
            document.head.append(script);
        }));
        if (ran === "loaded") told.push(`script ${place}`);
        await sockets;
    }));
    return told;
}
"""
#: lines for the socket, and messages for WebSockets: each of them would end or change the simulation
LINES = "\n".join(
    [
        *("1 simulation quit []", '2 simulation spawn ["victim", "ATRV"]', '{"type":"hello","version":3}'),
        *('{"op":"call_service","service":"/simulation/quit"}', '{"type":"quit"}', ""),
    ]
)


class _Page(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        body = b"<!doctype html><title>evil</title><body></body>"
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        pass


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[int]:
    """The port of a web server of others, on this machine."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Page)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server.server_address[1]
    server.shutdown()
    server.server_close()


@pytest.fixture(scope="module")
def stranger(browser: Browser) -> Iterator[Browser]:
    """A browser for which the name of a stranger points to this machine."""
    rules = f"--host-resolver-rules=MAP {EVIL} 127.0.0.1"
    chromium = os.environ.get("MORSE_CHROMIUM", "/usr/bin/chromium")
    other = browser.browser_type.launch(executable_path=chromium, args=["--no-sandbox", rules])
    yield other
    other.close()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    options = ("--view-port", "0", "--no-browser")
    with limited_run(SCENE, tmp_path_factory.mktemp("run"), 1024, *options) as running:
        yield running


def _ports(run: Run) -> dict[str, int]:
    services = run.port(r"services are on port (\d+)")
    ports = {
        "services": services,
        "view": run.port(r"live view is at http://127\.0\.0\.1:(\d+)/"),
        "rosbridge": run.port(r"rosbridge.*ws://[^:]+:(\d+)"),
        "foxglove": run.port(r"foxglove.*ws://[^:]+:(\d+)"),
    }
    (answer,) = json.loads(b"[" + call(services).partition(b"SUCCESS ")[2].strip() + b"]")
    return {**ports, **answer}


@pytest.mark.parametrize(
    ("page", "target"), [("localhost", "127.0.0.1"), ("127.0.0.1", "localhost"), (EVIL, "127.0.0.1"), (EVIL, EVIL)]
)
def test_pages_of_others_reach_nothing(run: Run, stranger: Browser, elsewhere: int, page: str, target: str) -> None:
    """A page of another server, also of this machine; its name may be made to point to the simulation afterwards."""
    ports = _ports(run)
    with stranger.new_page() as tab:
        tab.goto(f"http://{page}:{elsewhere}/")
        told = tab.evaluate(ATTACK, [target, list(ports.values()), LINES])
    assert told == []
    answer = call(ports["services"], b"1 simulation list_robots []\n")
    assert b'["robot"]' in answer, "nothing was called"


def test_a_rebinding_name_gets_no_page(run: Run, stranger: Browser) -> None:
    with stranger.new_page() as tab:
        answer = tab.goto(f"http://{EVIL}:{_ports(run)['view']}/")
        assert answer is not None
        assert answer.status == 403
        assert "localhost only" in tab.content()
        assert tab.evaluate(ATTACK, [EVIL, [*_ports(run).values()], LINES]) == []


@pytest.mark.parametrize("page", [EVIL, "localhost"])
def test_the_view_in_a_frame_of_others(run: Run, stranger: Browser, elsewhere: int, page: str) -> None:
    """Only pages of this machine may show it, such as notebooks; they can read nothing of it."""
    view = f"http://127.0.0.1:{_ports(run)['view']}/"
    with stranger.new_page() as tab:
        tab.goto(f"http://{page}:{elsewhere}/")
        read = tab.evaluate(
            """(view) => new Promise((done) => {
                const frame = document.createElement("iframe");
                frame.src = view;
                frame.onload = () => {
                    try { done(frame.contentDocument?.title ?? "nothing"); } catch { done("nothing"); }
                };
                document.body.append(frame);
            })""",
            view,
        )
        assert read == "nothing"
        frames = [frame for frame in tab.frames if frame.parent_frame is not None]
        shown = any("MORSE" in frame.title() for frame in frames if frame.url == view)
        assert shown is (page == "localhost")


def test_the_page_itself_is_shown(run: Run, stranger: Browser) -> None:
    """The attacks fail for their origin, not because nothing answers."""
    ports = _ports(run)
    with stranger.new_page() as tab:
        tab.goto(f"http://127.0.0.1:{ports['view']}/")
        told = tab.evaluate(ATTACK, ["127.0.0.1", [ports["view"]], '{"type":"nonsense"}'])
    assert any(line.startswith("cors") for line in told)
    assert any(line.startswith("WebSocket") for line in told)
