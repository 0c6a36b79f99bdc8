"""Creates the pictures of the live view in README and documentation: ``python tools/gallery/take.py FOLDER``.

Runs each scene of this folder, opens its page in Chromium and saves a screenshot as PNG. Software GL is sufficient.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

HERE = Path(__file__).parent
CHROMIUM = os.environ.get("MORSE_CHROMIUM", "/usr/bin/chromium")
START = "import sys; from morse.cli import main; sys.exit(main())"
WAIT = 180.0


@dataclass(frozen=True)
class Shot:
    """A picture.

    Attributes:
        steps: JavaScript to run on the page before the screenshot.
    """

    scene: str
    name: str
    theme: str = "light"
    size: tuple[int, int] = (1440, 900)
    steps: list[str] = field(default_factory=list)


SELECT = "morse.components.selected.set('{}')".format
LAYER = "morse.panels.layers.switch('{}', true)".format
NO_TREE = "morse.shell.left.hidden || morse.shell.toggle('left')"
PLOT = "morse.panels.plots.plot('{}', '{}')".format

SHOTS = [
    Shot("sandbox", "sandbox", steps=[NO_TREE]),
    Shot("sandbox", "inspector", steps=[SELECT("robot.pose"), LAYER("rays"), "wait", PLOT("robot.pose", "x"), "wait"]),
    Shot("sandbox", "sandbox-dark", theme="dark", steps=[SELECT("robot.laser"), LAYER("rays"), "wait"]),
    Shot("indoors", "indoors", steps=[LAYER("rays"), LAYER("names"), "wait"]),
    Shot("outdoors", "outdoors", steps=[NO_TREE]),
    Shot("office", "office", steps=[NO_TREE, LAYER("rays"), "wait"]),
    Shot("warehouse", "warehouse", steps=[NO_TREE, LAYER("rays"), "wait"]),
    Shot("many", "many-robots", steps=[NO_TREE]),
    Shot("sandbox", "phone", size=(390, 780)),
]


def until(page: Page, expression: str) -> None:
    """Wait until an expression is true on the page."""
    end = time.monotonic() + WAIT
    while not page.evaluate(f"!!({expression})"):
        if time.monotonic() > end:
            raise TimeoutError(f"timeout on the page: {expression}")
        time.sleep(0.1)


def take(browser: Browser, shot: Shot, folder: Path) -> None:
    """Run the scene and save the picture."""
    log = folder / f"{shot.name}.txt"
    with log.open("w") as out, tempfile.TemporaryDirectory() as empty:
        command = [sys.executable, "-u", "-c", START, "run", "--view-port", "0", str(HERE / f"{shot.scene}.py")]
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, cwd=empty)
        try:
            page = browser.new_page(
                viewport={"width": shot.size[0], "height": shot.size[1]},
                color_scheme=shot.theme,  # type: ignore[arg-type]
            )
            page.goto(address(log, process) + "?quality=high")
            until(page, "window.morse?.world.value && morse.poses.value && morse.stage.frames > 2")
            for step in shot.steps:
                if step == "wait":
                    frames = page.evaluate("morse.stage.frames")
                    until(page, f"morse.stage.frames > {frames} + 4")
                else:
                    page.evaluate(step)
            page.evaluate("morse.connection.send({type: 'pause'})")
            until(page, "!morse.poses.value.running")
            page.evaluate("document.querySelector('.history').style.display = 'none'")  # covers the scene
            page.screenshot(path=folder / f"{shot.name}.png", timeout=120_000)
            page.close()
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(20)
    log.unlink()


def address(log: Path, process: subprocess.Popen[bytes]) -> str:
    """The address of the live view, from the log."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end and process.poll() is None:
        found = re.search(r"http://\S+", log.read_text())
        if found:
            return found.group(0)
        time.sleep(0.1)
    raise RuntimeError(f"the simulation did not start:\n{log.read_text()}")


def main() -> None:
    """Create all pictures, or those named after the folder."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    flags = [
        "--no-sandbox",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-background-networking",
    ]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        for shot in SHOTS:
            if not sys.argv[2:] or shot.name in sys.argv[2:]:
                take(browser, shot, folder)
                print(f"{shot.name}.png")
        browser.close()


if __name__ == "__main__":
    main()
