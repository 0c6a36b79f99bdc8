"""A browser for pictures of the live view and of terminals, with one or several frames per file."""

from __future__ import annotations

import html
import io
import time
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image
from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    import pymorse

HERE = Path(__file__).parent
CHROMIUM = "/usr/bin/chromium"
ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
#: maximum size of a picture, bytes
LIMIT = 250_000
_PATIENCE = 90.0

WITHOUT_TIMELINE = "document.querySelector('.history').style.display = 'none'"
_LOOK = """([position, target]) => {
    const { stage } = window.morse;
    stage.view.position.set(...position);
    stage.target.set(...target);
    stage.view.lookAt(stage.target);
    stage.invalidate();
}"""
_TERMINAL = """<!doctype html><meta charset="utf-8"><style>
body { margin: 0; background: #1c2228; color: #dce4ea; font: 15px/1.5 'DejaVu Sans Mono', monospace; }
pre { margin: 0; padding: 18px 20px; white-space: pre-wrap; word-break: break-all; font: inherit; }
b { color: #7fd1c4; font-weight: normal; } i { color: #f0b673; font-style: normal; }
</style><pre>"""


class Studio:
    """A browser; used as a context manager."""

    def __init__(self, width: int = 1280, height: int = 720) -> None:
        self._playwright = sync_playwright().start()
        self._browser = self._playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        self.page = self._browser.new_page(viewport={"width": width, "height": height})

    def __enter__(self) -> Studio:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._browser.close()
        self._playwright.stop()

    def watch(self, url: str, quality: str = "high") -> None:
        """Open the live view, and wait until the world is loaded."""
        self.page.goto(f"{url}?quality={quality}")
        self.until("window.morse?.world.value && window.morse?.poses.value", "the world")

    def hide_tree(self) -> None:
        """Hide the tree of objects."""
        self.page.evaluate("window.morse.shell.left.hidden || window.morse.shell.toggle('left')")

    def look(self, position: Sequence[float], target: Sequence[float]) -> None:
        """Put the camera somewhere, metres in the world."""
        self.page.evaluate(_LOOK, [list(position), list(target)])

    def still(self, simulation: pymorse.Morse) -> Image.Image:
        """A picture of the page while time is stopped, without the slider over the scene; time remains stopped."""
        simulation.rpc("simulation", "pause")
        self.until("!window.morse.poses.value.running", "the pause")
        self.page.evaluate(WITHOUT_TIMELINE)
        return self.shot()

    def shot(self) -> Image.Image:
        """A picture of the page."""
        time.sleep(1.0)  # until the frame for the last message is rendered
        return Image.open(io.BytesIO(self.page.screenshot())).convert("RGB")

    def terminal(self, text: str, width: int, height: int) -> Image.Image:
        """Lines of a terminal; lines that begin with ``$`` are typed commands. Leaves the live view."""
        self.page.goto("about:blank")
        self.page.set_viewport_size({"width": width, "height": height})
        lines = [html.escape(line) for line in text.splitlines()]
        self.page.set_content(
            _TERMINAL + "\n".join(f"<i>$</i> <b>{line[2:]}</b>" if line[:2] == "$ " else line for line in lines)
        )
        return self.shot()

    def until(self, condition: str, what: str) -> None:
        """Wait until a condition is true on the page."""
        # the content security policy of the page forbids what Playwright's wait functions need
        end = time.monotonic() + _PATIENCE
        while not self.page.evaluate(f"Boolean({condition})"):
            if time.monotonic() > end:
                raise TimeoutError(f"waited {_PATIENCE:g} s for {what}")
            time.sleep(0.05)


def beside(left: Image.Image, right: Image.Image) -> Image.Image:
    """Two pictures of the same height in one."""
    both = Image.new("RGB", (left.width + right.width, left.height))
    both.paste(left, (0, 0))
    both.paste(right, (left.width, 0))
    return both


def save(name: str, frames: Sequence[Image.Image], milliseconds: int = 0, limit: int = LIMIT) -> Path:
    """Write a picture, or a film of several frames, with the best quality that the size limit allows.

    Raises:
        ValueError: it exceeds the limit at any compression.
    """
    path = HERE / f"{name}.webp"
    first, *others = frames
    for quality in (90, 82, 74, 66, 58, 50, 42, 34):
        buffer = io.BytesIO()
        options = {"save_all": True, "append_images": others, "duration": milliseconds, "loop": 0} if others else {}
        first.save(buffer, "WEBP", quality=quality, method=6, **options)
        if buffer.tell() <= limit:
            path.write_bytes(buffer.getvalue())
            return path
    raise ValueError(f"{path.name} would have more than {limit} bytes")
