"""A server of the live view, pages on plain sockets, and real pages."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import pytest
from editor_desk import MODELS, SCENE, Desk
from playwright.sync_api import Error
from shared_views import SharedScenes, SharedView
from view_pages import Client
from view_simulation import CircleDriver
from view_worlds import playground

import morse
from morse.core.clients.network import Network
from morse.viewer.catalog import Catalog
from morse.viewer.server import ViewServer
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser, BrowserContext, Page


#: size of a page whose size does not matter
NARROW = {"width": 640, "height": 420}
#: a processor draws slowly, and a page that draws all the time leaves little of it to the test: 5 frames a second do
FEW_FRAMES = """
(() => {
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => request(draw), 200);
    window.cancelAnimationFrame = clearTimeout.bind(window);
})();
"""
#: toasts vanish after a few seconds, in which a loaded machine may not look at the page: `view_pages.toasts`
KEPT_TOASTS = """
window.toasts = [];
new MutationObserver((changes) => {
    for (const change of changes)
        for (const node of change.addedNodes)
            if (node.classList?.contains("toast")) toasts.push({ kind: node.className, text: node.innerText });
}).observe(document, { childList: true, subtree: true });
"""


@pytest.fixture
def network() -> Iterator[Network]:
    network = Network()
    yield network
    network.stop()


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    """A page beside a robot, in the scene `SCENE`, with the models `MODELS`."""
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        yield desk


@pytest.fixture
def make_server(network: Network) -> Iterator[Callable[..., tuple[ViewServer, str]]]:
    """Starts servers on free ports; returns each with its address."""
    servers: list[ViewServer] = []

    def make(**options: Any) -> tuple[ViewServer, str]:
        server = ViewServer(network, **{"port": 0, **options})
        url = server.start()
        servers.append(server)
        return server, url

    yield make
    for server in servers:
        server.stop()


@pytest.fixture
def served(make_server: Callable[..., tuple[ViewServer, str]]) -> tuple[ViewServer, str]:
    """A server without a world."""
    return make_server()


@pytest.fixture
def running(served: tuple[ViewServer, str]) -> Iterator[tuple[CircleDriver, str]]:
    """Robots that drive in circles, and the address of their live view."""
    server, url = served
    scene, moving = playground()
    server.set_scene(scene, moving)
    driver = CircleDriver(server, moving)
    server.send(driver.tree())
    with driver:
        yield driver, url


@pytest.fixture(scope="module")
def shared_view(request: pytest.FixtureRequest, open_shared_page: Callable[..., Page]) -> Iterator[SharedView]:
    """Robots that drive in circles, and a page for all tests of the file, `SIZE` large if the file says so."""
    with contextlib.closing(_Serving()) as serving:
        made = SharedView(*serving.open(), open_shared_page, getattr(request.module, "SIZE", NARROW))
        with made.driver:
            yield made


@pytest.fixture
def shown(request: pytest.FixtureRequest, shared_view: SharedView) -> Iterator[tuple[CircleDriver, Page]]:
    """As `running`, with an open page: both are put back to the beginning, and shared with the tests of the file."""
    driver, page = shared_view.fresh(request.session.testsfailed)
    yield driver, page
    driver.shown = False


@pytest.fixture(scope="module")
def shared_scenes(request: pytest.FixtureRequest, open_shared_page: Callable[..., Page]) -> Iterator[SharedScenes]:
    """A page for the scenes of all tests of the file."""
    with contextlib.closing(_Serving()) as serving:
        yield SharedScenes(*serving.open(), open_shared_page, NARROW)


@pytest.fixture
def scenes(request: pytest.FixtureRequest, shared_scenes: SharedScenes) -> SharedScenes:
    """A server without a world, and a page: both are shared with the tests of the file."""
    shared_scenes.fresh(request.session.testsfailed)
    return shared_scenes


class _Serving:
    """A server of the live view, with a network thread of its own."""

    def __init__(self) -> None:
        self._network = Network()
        self._server = ViewServer(self._network, port=0)

    def open(self) -> tuple[ViewServer, str]:
        return self._server, self._server.start()

    def close(self) -> None:
        self._server.stop()
        self._network.stop()


@pytest.fixture(scope="session")
def profile(browser: Browser) -> Iterator[BrowserContext]:
    """A window that stays open: a page in a new window takes twice the processor time of a page in a new tab."""
    context = browser.new_context()
    context.new_page()
    yield context
    context.close()


@pytest.fixture
def open_page(browser: Browser, profile: BrowserContext) -> Iterator[Callable[..., Page]]:
    """Opens pages of the live view; an error on a page fails the test.

    Pages of one test share nothing. Pages of different tests have different ports, and so different storages.
    """
    with opening(browser, profile) as opened:
        yield opened


@pytest.fixture(scope="module")
def open_shared_page(browser: Browser, profile: BrowserContext) -> Iterator[Callable[..., Page]]:
    """As `open_page`; the pages stay open for all tests of the file."""
    with opening(browser, profile) as opened:
        yield opened


@contextlib.contextmanager
def opening(browser: Browser, profile: BrowserContext) -> Iterator[Callable[..., Page]]:
    """The function that opens pages; closes them at the end."""
    contexts: list[BrowserContext] = []
    tabs: list[Page] = []
    errors: list[str] = []

    def opened(url: str, *, wait: bool = True, width: int = 640, height: int = 420, **options: Any) -> Page:
        size: Any = {"width": width, "height": height}
        scheme = options.pop("color_scheme", "light")
        if options or tabs:
            contexts.append(browser.new_context(viewport=size, **options))
            page = contexts[-1].new_page()
        else:
            page = profile.new_page()
            page.set_viewport_size(size)
            tabs.append(page)
        page.emulate_media(color_scheme=scheme)
        page.set_default_timeout(60_000)  # other programs may take most of the processor
        page.add_init_script(KEPT_TOASTS)
        page.add_init_script(FEW_FRAMES)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("dialog", lambda dialog: dialog.accept())  # a page that is left during a flight asks
        page.goto(url + ("&" if "?" in url else "?") + "quality=low")
        if wait:
            wait_until(
                lambda: page.evaluate("!!(window.morse?.world.value && morse.stage.frames > 0)"), "a world on the page"
            )
        return page

    yield opened
    for tab in tabs:
        if not tab.is_closed():
            with contextlib.suppress(Error):  # a page that could not be loaded has no storage
                tab.evaluate("localStorage.clear()")
            tab.close()
    for context in contexts:
        context.close()
    assert errors == []
