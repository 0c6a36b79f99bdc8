"""Simulations whose page the tests of a file share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from shared_page import SharedPage
from view_simulation import CircleDriver
from view_worlds import playground

from morse.scene import Scene
from morse.viewer.hub import Wishes
from morse.viewer.server import ViewServer
from morse.viewer.snapshot import MovingNode
from morse.viewer.view_messages import Tree
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page


class SharedView:
    """Robots that drive in circles, and their page."""

    def __init__(self, server: ViewServer, url: str, open_page: Callable[..., Page], size: dict[str, int]) -> None:
        scene, moving = playground()
        server.set_scene(scene, moving)
        self.driver = CircleDriver(server, moving)
        ready = "morse.seat.drives.value && morse.components.all.value.length === 6 && morse.poses.value?.running"
        self._page = SharedPage(open_page, url, f"!!({ready})", size)

    def fresh(self, failures: int) -> tuple[CircleDriver, Page]:
        """The simulation at its beginning, and its page; a new page if one more test has failed."""
        page = self._page.fresh(failures, self._begin)
        driver = self.driver
        wait_until(lambda: driver.server.wishes == Wishes(), "a page without wishes")
        last = driver.tick + 1  # the page has received what was sent before it has received later poses
        wait_until(lambda: page.evaluate("morse.poses.value.tick") > last, "the first ticks")
        page.evaluate("morse.components.live.clear()")
        driver.events.clear()
        return driver, page

    def _begin(self) -> None:
        wait_until(lambda: not self.driver.server.held_keys(), "no key is held")
        self.driver.begin()


class SharedScenes:
    """A page that shows one scene after another, each as if the page were new."""

    def __init__(self, server: ViewServer, url: str, open_page: Callable[..., Page], size: dict[str, int]) -> None:
        self.server = server
        self.revision = 0
        self._page = SharedPage(open_page, url, "morse.world.value?.description.nodes.length === 0", size)

    def fresh(self, failures: int) -> None:
        """Show nothing; on a new page if one more test has failed."""
        self._page.fresh(failures, self._begin)

    def show(self, scene: Scene, moving: Sequence[MovingNode] = ()) -> Page:
        """The page, when it has drawn the scene."""
        page = self._page.page
        self._describe(scene, moving)
        wait_until(lambda: page.evaluate("morse.world.value.description.revision") == self.revision, "the world")
        drawn = page.evaluate("(morse.stage.invalidate(), morse.stage.frames)")
        wait_until(lambda: page.evaluate("morse.stage.frames") > drawn, "a frame of the world")
        return page

    def _begin(self) -> None:
        self.server.send(Tree([]))
        self._describe(Scene("nothing"), ())

    def _describe(self, scene: Scene, moving: Sequence[MovingNode]) -> None:
        self.server._key = None  # another script: its viewpoint is taken, and nothing is restored
        self.server.set_scene(scene, moving)
        self.revision += 1
