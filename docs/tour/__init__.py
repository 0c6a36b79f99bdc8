"""A run for the documentation: as a page that is embedded, and as a moving picture.

As an extension of Sphinx, it writes the page ``_static/run.html`` whenever the documentation is built.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

SCENE = Path(__file__).with_name("scene.py")
SECONDS = 15.0
#: simulated seconds between two commands
_STEP = 0.5


def record(path: Path) -> None:
    """Record the run: the robot drives in waves."""
    import morse

    with morse.load(SCENE, record=path) as simulation:
        for number in range(round(SECONDS / _STEP)):
            simulation.robot.motion.publish({"v": 0.7, "w": 0.7 * math.sin(0.45 * number + 0.4)})
            simulation.step(round(_STEP * 60))


def write_page(target: Path) -> None:
    """Write the run as a page."""
    from morse.cli.app import execute

    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run.mcap"
        record(run)
        target.parent.mkdir(parents=True, exist_ok=True)
        if execute(["export", str(run), "--html", str(target)]):
            raise RuntimeError("the run of the documentation could not be exported")


def _finished(app: Sphinx, error: Exception | None) -> None:
    if error is None and app.builder.format == "html":
        # in a process of its own: the log of Sphinx is not that of a simulation
        code = "import sys; from pathlib import Path; import tour; tour.write_page(Path(sys.argv[1]))"
        target = str(Path(app.outdir) / "_static" / "run.html")
        subprocess.run([sys.executable, "-c", f"import sys; sys.path[:0] = {sys.path!r}; {code}", target], check=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.connect("build-finished", _finished)
    return {"parallel_read_safe": True}
