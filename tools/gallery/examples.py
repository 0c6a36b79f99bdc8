"""Creates the pictures of the examples: ``python tools/gallery/examples.py [NAME...]``, in ``docs/pictures/examples``.

The page ``docs/examples.md`` is generated from the examples as well. Each example runs in this process with its client,
and is rendered by the camera renderer: no browser is needed.
"""

from __future__ import annotations

import os
import runpy
import sys
import threading
from pathlib import Path

from PIL import Image

import morse
from morse.cli.examples import Example, examples

PICTURES = Path(__file__).parents[2] / "docs" / "pictures" / "examples"
PAGE = PICTURES.parents[1] / "examples.md"
SIZE = (800, 500)
_LINK = "../src/morse/data/examples"
_HEAD = """# Examples

Scenes with a client each, one for each family of robots, sensors and actuators. They are installed with MORSE:

```sh
morse demo
morse demo laser
morse demo laser --copy .
```

The first command lists them. The second command runs a scene in the live view; its client starts when the page shows
the scene. The third command copies both files, as a basis for your own scene. With `--headless` there is no live view, and
the simulation ends with the client.

[Programs that others wrote](../examples/README.md), such as KISS-ICP, OpenCV, a planner and MAVSDK, drive robots too.
"""
#: simulated seconds after which the picture is taken, if not at the end of the client
MOMENTS = {
    "waypoints": 8.0,
    "quadrotor": 4.0,
    "battery": 9.0,
    "lights": 1.1,
    "laser": 6.0,
    "drive": 5.0,
    "rescue": 3.0,
    "legs": 5.0,
    "human": 3.1,
}


def take(example: Example) -> Path:
    """Run an example and save its picture."""
    os.environ["MORSE_SOCKET_PORT"] = "0"
    moment = MOMENTS.get(example.name)
    with morse.load(example.scene, sockets=True, speed=2.0) as simulation:
        (manager,) = simulation.context.services.request_managers().values()
        os.environ["MORSE_SOCKET_PORT"] = str(manager.port)
        client = threading.Thread(target=_client, args=[example, simulation], daemon=True)
        client.start()
        simulation.run(moment)
        picture = Image.fromarray(simulation.picture(*SIZE))
    path = PICTURES / f"{example.name}.webp"
    path.parent.mkdir(exist_ok=True)
    picture.save(path, "WEBP", quality=82, method=6)
    return path


def _client(example: Example, simulation: morse.Simulation) -> None:
    try:
        runpy.run_path(str(example.client))["main"]()
    except Exception as error:  # the simulation ends while it drives
        print(f"{example.name}: {type(error).__name__}")
    simulation.stop()


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
    for example in examples().values():
        if not names or example.name in names:
            print(take(example))
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
