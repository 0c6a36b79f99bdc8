"""Time of a running browser from the address of the live view to the first frame with the world.

``first_picture CHROMIUM``, the path of the browser.
"""

from __future__ import annotations

import re
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import sync_playwright

from benchmarks import stopwatch
from morse.testing.process import SimulationProcess

if TYPE_CHECKING:
    from playwright.sync_api import Page

_SCENE = Path(__file__).parents[1] / "scenes" / "sandbox.py"
# also without a graphics card; a browser in a container has no sandbox of its own
_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]
_PATIENCE = 60.0  # s
_SIZE = 1280, 720
# the page's object is created when its script runs; a frame counts once it contains the world
_WATCH = """Object.defineProperty(window, "morse", { set(app) {
    Object.defineProperty(window, "morse", { value: app });
    app.stage.onDrawn(() => { if (app.stage.world !== null) window.pictured ??= performance.now(); });
}, configurable: true });"""


def seconds(chromium: str, address: str) -> tuple[float, float]:
    """Time from the address to the first frame, for a first visit and for the next one, with cached files."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=_FLAGS)
        # the graphics of a running browser are initialised
        idle = browser.new_page()
        idle.set_content("<canvas></canvas><script>document.querySelector('canvas').getContext('webgl2')</script>")
        context = browser.new_context(viewport={"width": _SIZE[0], "height": _SIZE[1]})
        context.add_init_script(_WATCH)
        taken = []
        for _ in range(2):
            page = context.new_page()
            page.goto(address)
            taken.append(_pictured(page))
            page.close()
        browser.close()
    return taken[0], taken[1]


def _pictured(page: Page) -> float:
    # the content security policy forbids evaluating text, which the usual wait functions need
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        if (milliseconds := page.evaluate("window.pictured ?? null")) is not None:
            return float(milliseconds) / 1e3
        page.wait_for_timeout(20)
    raise RuntimeError(f"no picture of the world within {_PATIENCE:.0f} s")


def main() -> None:
    """Run once."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        process = SimulationProcess(_SCENE, log, options=("--view-port", "0", "--no-browser"))
        try:
            process.wait_initialized()
            found = re.search(r"http://\S+", log.read_text())
            if found is None:
                raise RuntimeError(f"the log does not contain the address of the live view:\n{log.read_text()}")
            first, again = seconds(sys.argv[1], found[0])
        finally:
            process.stop()
    stopwatch.report(first_s=first, again_s=again)


if __name__ == "__main__":
    main()
