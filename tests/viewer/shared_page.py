"""A page that tests use one after another: opening one takes more time than most tests need."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page

#: seconds until a page that is not as it was is replaced
PATIENCE = 10.0
STORED = "[{ ...localStorage }, { ...sessionStorage }]"
#: lets the Tab key begin at the first control, whatever had the focus before
FROM_THE_TOP = """{
    const first = document.createElement("span");
    first.tabIndex = -1;
    document.body.prepend(first);
    first.focus();
    first.remove();
}"""
#: undoes what tests do to a page; the argument is the content of its storages when it was new
PUT_BACK = """(stored) => {
    const { components, follow, keyboard, memory, panels, shell } = morse;
    for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close();
    for (const menu of document.querySelectorAll("details.menu[open]")) menu.open = false;
    for (const toast of document.querySelectorAll(".toast")) toast.remove();
    toasts.length = 0;
    FROM_THE_TOP
    keyboard.release();
    panels.mover.toggle(null);
    panels.ruler.on.set(false);
    components.selected.set(null);
    panels.images.follows.set(true);
    for (const camera of panels.images.open.value) panels.images.toggle(camera);
    for (const plot of [...panels.plots.plots]) plot.onEmpty();
    for (const { id, on } of panels.layers.list) if (on) panels.layers.switch(id, false);
    const filter = document.querySelector(".tree-panel input");
    filter.value = "";
    filter.dispatchEvent(new Event("input"));
    const folded = "[role=treeitem][aria-expanded=false]:not([data-name=objects]) .fold";
    for (const fold of document.querySelectorAll(folded)) fold.click();
    if (!shell.bottom.hidden) shell.toggle("bottom");
    shell.closed.clear();
    if (!shell.narrow && shell.left.hidden) shell.toggle("left");
    memory.forget();
    follow.goHome();
    for (const [storage, was] of [[localStorage, stored[0]], [sessionStorage, stored[1]]]) {
        storage.clear();
        for (const [key, value] of Object.entries(was)) storage.setItem(key, value);
    }
}""".replace("FROM_THE_TOP", FROM_THE_TOP)
#: what a test may have changed on a page: everything that is shown, what is stored, the camera, keys, overlays
LOOK = """(() => {
    const elements = [...document.querySelectorAll("body, body *")].filter((e) => e.checkVisibility());
    const shown = elements.filter((e) => !e.closest("output")).map((e) => [ // outputs show the time
        e.tagName, e.getAttribute("class"), e.getAttribute("style"), e.ariaLabel, e.ariaPressed === "true",
        e.ariaExpanded, e.ariaSelected, e.ariaInvalid, e.hidden, e.disabled, e.open, e.value, e.checked,
        e.dataset?.news, e.childElementCount ? "" : e.textContent,
    ].join("|"));
    const { components, follow, keyboard, navigation, panels, stage } = morse;
    const { dataset, style } = document.documentElement;
    const { position, yaw, pitch, roll } = stage.view.pose;
    const layers = panels.layers.list.map(({ id, on, root }) => [id, on, root.children.length]);
    const camera = [...position, yaw, pitch, roll].map((x) => x.toFixed(6));
    return JSON.stringify([
        shown, STORED, camera, follow.mode.value, navigation.velocity.length(), [...keyboard.held], layers,
        components.all.value, stage.ground.mesh.visible, dataset.theme, style.cssText,
    ], null, 1);
})()""".replace("STORED", STORED)


class SharedPage:
    """A page that is at the beginning of each test as it was when it was new."""

    def __init__(self, open_page: Callable[..., Page], url: str, ready: str, size: dict[str, int]) -> None:
        """Open no page yet.

        Args:
            open_page: opens a page.
            url: its address.
            ready: JavaScript condition: the page shows all that it is sent at first.
            size: of the window, pixels.
        """
        self._open = open_page
        self._url = url
        self._ready = ready
        self._size: Any = size
        self.page: Any = None
        self._failures = 0
        self._look = ""
        self._stored: Any = None

    def fresh(self, failures: int, begin: Callable[[], None]) -> Page:
        """The page; a new one if a test has failed meanwhile, or has left traces.

        Args:
            failures: number of tests that have failed so far.
            begin: puts back what the server sends.
        """
        page: Page | None = self.page
        known, self._failures = self._failures, failures
        if page is not None and failures == known and self._put_back(page, begin):
            return page
        if page is not None:
            page.close()
        begin()
        page = self.page = self._open(self._url, **self._size)
        wait_until(lambda: page.evaluate(self._ready), self._ready)
        page.mouse.move(0, 0)
        self._stored = page.evaluate(STORED)
        page.evaluate(PUT_BACK, self._stored)
        self._look = page.evaluate(LOOK)
        return page

    def _put_back(self, page: Page, begin: Callable[[], None]) -> bool:
        page.bring_to_front()
        page.mouse.move(0, 0)
        if page.viewport_size != self._size:
            page.set_viewport_size(self._size)
        page.evaluate(PUT_BACK, self._stored)
        begin()
        try:
            wait_until(lambda: page.evaluate(self._ready) and page.evaluate(LOOK) == self._look, limit=PATIENCE)
        except AssertionError:
            old, now = self._look.splitlines(), page.evaluate(LOOK).splitlines()
            traces = [line for line in (*old, *now) if (line in old) != (line in now)]
            warnings.warn(f"a test has left traces on a page, which is replaced: {traces[:10]}", stacklevel=2)
            return False
        return True
