"""A server of the live view, pages on plain sockets, and real pages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from view_pages import until
from view_simulation import CircleDriver
from view_worlds import playground

from morse.core.network import Network
from morse.viewer.server import ViewServer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser, BrowserContext, Page


@pytest.fixture
def network() -> Iterator[Network]:
    network = Network()
    yield network
    network.stop()


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


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Opens pages of the live view; an error on a page fails the test."""
    contexts: list[BrowserContext] = []
    errors: list[str] = []

    def opened(url: str, *, wait: bool = True, width: int = 640, height: int = 420, **options: Any) -> Page:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("dialog", lambda dialog: dialog.accept())  # a page that is left during a flight asks
        page.goto(url + ("&" if "?" in url else "?") + "quality=low")
        if wait:
            until(
                lambda: page.evaluate("!!(window.morse?.world.value && morse.stage.frames > 0)"), "a world on the page"
            )
        return page

    yield opened
    for context in contexts:
        context.close()
    assert errors == []
