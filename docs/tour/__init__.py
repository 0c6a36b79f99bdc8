"""Runs for the documentation, as pages that are embedded, and as a moving picture.

As an extension of Sphinx, it writes the pages ``_static/runs/NAME.html`` whenever the documentation is built, and puts
each of them over the picture that stands for it where there is no browser.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).parent
SECONDS = 15.0
#: simulated seconds between two commands
_STEP = 0.5
#: the scenes of this folder, and the speeds and turning rates that are commanded every half second
_DRIVES = {
    "tour": lambda number: (0.7, 0.7 * math.sin(0.45 * number + 0.4)),
    "first": lambda number: (1.6, 0.0) if number < 11 else (0.8, 1.5),
}
#: the examples that are shown, with the seconds of their runs
EXAMPLES = {"camera": 10.0, "gripper": 12.0, "laser": 20.0, "legs": 10.0, "quadrotor": 15.0}
#: the picture of a run, in the folder of the documentation
_PICTURES = {
    "pictures/tour.webp": "tour",
    "pictures/morsy.webp": "first",
    **{f"pictures/examples/{name}.webp": name for name in EXAMPLES},
}
#: simulated seconds per second: a client keeps up with it
_SPEED = 4.0


def record(name: str, path: Path) -> None:
    """Record a run: that of a scene of this folder, in which the robot is driven, or of an example with its client."""
    import morse

    if name in EXAMPLES:
        from morse.cli.demo import example
        from tour.playing import playing

        with playing(example(name), speed=_SPEED, record=path) as (simulation, client):
            client.start()
            simulation.run(EXAMPLES[name])
        return
    with morse.load(HERE / f"{name}.py", record=path) as simulation:
        for number in range(round(SECONDS / _STEP)):
            v, w = _DRIVES[name](number)
            simulation.robot.motion.publish({"v": v, "w": w})
            simulation.step(round(_STEP * 60))


def write_page(name: str, target: Path) -> None:
    """Write a run as a page."""
    from morse.cli.app import execute

    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run.mcap"
        record(name, run)
        target.parent.mkdir(parents=True, exist_ok=True)
        if execute(["export", str(run), "--html", str(target)]):
            raise RuntimeError(f"the run '{name}' of the documentation could not be exported")


def _resolved(app: Sphinx, document: nodes.document, name: str) -> None:
    if app.builder.format != "html":
        return
    up = "../" * name.count("/")
    for image in list(document.findall(nodes.image)):
        run = _PICTURES.get(image["uri"])
        if run is None:
            continue
        page = f"{up}_static/runs/{run}.html#loop"
        start = f'<span class="run"><a href="{page}" title="Play this run">'
        frame = f'</a><iframe data-src="{page}" title="A recorded run"></iframe></span>'
        image.parent.insert(image.parent.index(image), nodes.raw("", start, format="html"))
        image.parent.insert(image.parent.index(image) + 1, nodes.raw("", frame, format="html"))


def _finished(app: Sphinx, error: Exception | None) -> None:
    if error is not None or app.builder.format != "html":
        return
    # in processes of their own: the log of Sphinx is not that of a simulation
    code = "import sys; from pathlib import Path; import tour; tour.write_page(sys.argv[1], Path(sys.argv[2]))"
    for name in (*_DRIVES, *EXAMPLES):
        target = str(Path(app.outdir) / "_static" / "runs" / f"{name}.html")
        subprocess.run(
            [sys.executable, "-c", f"import sys; sys.path[:0] = {sys.path!r}; {code}", name, target], check=True
        )


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.connect("doctree-resolved", _resolved)
    app.connect("build-finished", _finished)
    return {"parallel_read_safe": True}
