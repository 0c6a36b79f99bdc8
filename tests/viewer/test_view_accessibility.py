"""axe finds nothing serious on the page, in light and dark, on a screen and a telephone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from morse.viewer.server import ViewServer
from morse.viewer.view_messages import Model, Models, SceneChanges
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page


AXE = Path(__file__).parents[2] / "viewer" / "node_modules" / "axe-core" / "axe.min.js"
#: parts of the page that are opened one after another
PARTS = {
    "the page": "true",
    "a sensor": "morse.shell.show('left'), morse.components.selected.set('robot0.lidar')",
    "its details": "morse.shell.show('right')",
    "a plot": "morse.panels.plots.plot('robot0.lidar', 'x'), morse.shell.show('bottom')",
    "the models": "morse.shell.show('left'), morse.panels.editor.toggle()",
    "the view menu": "document.querySelector('details.menu').open = true",
    "a message": "morse.toasts.show('Something is wrong.', 'error')",
    "the keys": "morse.panels.help.toggle()",
}
SERIOUS = """async () => {
    const { violations } = await axe.run(document, { resultTypes: ["violations"] });
    return violations.filter(({ impact }) => ["serious", "critical"].includes(impact))
        .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 80)).join("; ")}`);
}"""


@pytest.mark.skipif(not AXE.is_file(), reason="`npm ci` in the folder viewer/ installs axe")
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_nothing_on_the_page_is_a_serious_barrier(
    served: tuple[ViewServer, str],
    running: tuple[object, str],
    open_page: Callable[..., Page],
    scheme: str,
    width: int,
) -> None:
    server, url = served
    server.send(SceneChanges(2, "atrv was added", "", "scene.py"))
    server.send(Models([Model("ATRV", "ATRV", "robots"), Model("props/crates#crate", "crate", "crates")]))
    page = open_page(url, width=width, height=740, color_scheme=scheme)
    wait_until(
        lambda: page.evaluate("morse.components.all.value.length > 0 && !morse.panels.editor.element.hidden"), "all"
    )
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = {}
    for part, opening in PARTS.items():
        page.evaluate(f"void ({opening})")
        if serious := page.evaluate(SERIOUS):
            found[part] = serious
    assert found == {}
