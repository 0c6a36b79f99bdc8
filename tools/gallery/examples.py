"""Creates the pictures of the examples: ``python tools/gallery/examples.py [NAME...]``, in ``docs/pictures/examples``.

The page ``docs/examples.md`` is generated from the examples as well. Each example runs in this process with its client;
the picture is that of its page in Chromium, with all that the scene shows.
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, cast

import morse
from morse.cli.demo import Example, examples

DOCS = Path(__file__).parents[2] / "docs"
sys.path[:0] = [str(DOCS), str(DOCS / "pictures")]

from studio import Studio  # noqa: E402
from tour.playing import playing  # noqa: E402

if TYPE_CHECKING:
    from morse.viewer.live_view import View

PICTURES = DOCS / "pictures" / "examples"
PAGE = PICTURES.parents[1] / "examples.md"
#: pixels of the page, which is shown as wide as the text
SIZE = (960, 600)
_LINK = "../src/morse/data/examples"
_HEAD = """# Examples

Each example is a scene with a client. There is one for each family of robots, sensors and actuators. They are installed
with MORSE:

```sh
morse demo
morse demo laser
morse demo laser --copy .
```

The first command lists them. The second command runs a scene in the live view; its client starts when the page shows
the scene. The third command copies both files, as a basis for your own scene. With `--headless` there is no live view,
and the simulation ends with the client.

[Programs of other projects](../examples/README.md), such as KISS-ICP, OpenCV, a planner and MAVSDK, drive robots, too.
"""
#: a paused page draws all pixels, and shows a slider that belongs to no example, nor does the load of the machine
WITHOUT_TIMELINE = "for (const one of document.querySelectorAll('.history, .log')) one.style.display = 'none'"
#: simulated seconds after which the picture is taken, if not at the end of the client
MOMENTS = {
    "waypoints": 8.0,
    "quadrotor": 4.0,
    "battery": 9.0,
    "lights": 1.1,
    "semantic": 1.6,
    "laser": 6.0,
    "drive": 5.0,
    "rescue": 3.0,
    "legs": 5.0,
    "human": 3.1,
    "depot": 19.0,
    "warehouse": 20.5,
    "hospital": 27.0,
    "mall": 33.0,
}


def take(example: Example, studio: Studio) -> Path:
    """Run an example, and save a picture of its page."""
    with playing(example, morse.Simulation.pause, view="web", speed=1.0) as (simulation, client):
        view = cast("View", simulation.view)
        ticks = threading.Thread(target=simulation.run, args=[600.0], daemon=True)
        ticks.start()
        studio.watch(view.url, quality="auto")
        studio.hide_tree()
        begin = simulation.time()
        client.start()
        moment = MOMENTS.get(example.name)
        while client.is_alive() and (moment is None or simulation.time() < begin + moment):
            time.sleep(0.02)
        simulation.pause()
        studio.until("!morse.poses.value.running", "the pause")
        studio.page.evaluate(WITHOUT_TIMELINE)
        picture = studio.shot()
        simulation.stop()
        ticks.join()
    path = PICTURES / f"{example.name}.webp"
    path.parent.mkdir(exist_ok=True)
    picture.save(path, "WEBP", quality=82, method=6)
    return path


def page() -> str:
    """The page that shows all examples."""
    parts = [_HEAD.rstrip("\n") + "\n"]
    for each in examples().values():
        picture = f"![{each.what}](pictures/examples/{each.name}.webp)"
        files = ", ".join(f"[{file.name}]({_LINK}/{each.name}/{file.name})" for file in (each.scene, each.client))
        parts.append(f"## {each.name}\n\n{each.what}\n\n{picture}\n\n`morse demo {each.name}`: {files}\n")
    return "\n".join(parts)


def main(names: list[str]) -> None:
    """Create the pictures of these examples, or of all."""
    with Studio(*SIZE) as studio:
        for example in examples().values():
            if not names or example.name in names:
                print(take(example, studio))
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
