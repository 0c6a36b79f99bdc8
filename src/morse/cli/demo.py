"""``morse demo``: list the examples, or run one."""

from __future__ import annotations

import ast
import os
import shutil
import socket
import subprocess
import sys
import textwrap
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from morse.cli.messages import CommandError, nearest, say
from morse.cli.run import parse_speed
from morse.core.reports import log
from morse.core.reports.printing import echo
from morse.simulation.options import RunOptions
from morse.viewer.display import has_display

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View

FOLDER = Path(__file__).resolve().parents[1] / "data" / "examples"


@dataclass(frozen=True, slots=True)
class Example:
    """A scene script and a client program for it.

    Attributes:
        name: name of its folder.
        what: a description in one line.
    """

    name: str
    what: str

    @property
    def scene(self) -> Path:
        """The scene script."""
        return FOLDER / self.name / "scene.py"

    @property
    def client(self) -> Path:
        """The program; it ends by itself."""
        return FOLDER / self.name / "client.py"


def examples() -> dict[str, Example]:
    """All examples by name, sorted."""
    return {path.parent.name: _read(path) for path in sorted(FOLDER.glob("*/scene.py"))}


def example(name: str) -> Example:
    """The example of that name.

    Raises:
        CommandError: there is no such example.
    """
    by_name = examples()
    if name not in by_name:
        raise CommandError(f"There is no example '{name}'.{nearest(name, by_name)} `morse demo` lists all examples.")
    return by_name[name]


def _read(scene: Path) -> Example:
    text = ast.get_docstring(ast.parse(scene.read_text(encoding="utf-8"))) or ""
    return Example(scene.parent.name, text.partition("\n")[0])


_PATIENCE = 5.0
#: characters of a line of the description of an example
_NARROWEST = 16
#: seconds between two looks whether a page shows the scene
_PAUSE = 0.1


def command(
    name: Annotated[
        str | None, typer.Argument(help="Name of the example; without it, all examples are listed.", show_default=False)
    ] = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="No live view; the simulation ends with the client.")
    ] = False,
    client: Annotated[bool, typer.Option("--client/--no-client", help="Also run the client of the example.")] = True,
    speed: Annotated[
        str | None,
        typer.Option("--speed", metavar="X|max", help="Simulated seconds per second, or as fast as possible."),
    ] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the live view in a browser.")] = True,
    copy: Annotated[
        Path | None, typer.Option("--copy", metavar="FOLDER", help="Do not run the example: copy it to this folder.")
    ] = None,
) -> int:
    """List the examples, or run one: a scene in the live view, and a client that drives the robot."""
    if name is None:
        if copy is not None or headless:
            raise CommandError("Which example? `morse demo` lists all examples.", status=2)
        _list()
        return 0
    demo = example(name)
    if copy is not None:
        _copy(demo, copy)
        return 0
    options = RunOptions(
        script=str(demo.scene),
        node_name=socket.gethostname(),
        view="none" if headless else "web",
        open_browser=browser,
        speed=parse_speed(speed),
    )
    log.setup()
    # imported on demand, so that the list does not load the simulator
    from morse.launch.run import run

    own = _Client(demo, ends_the_simulation=headless)
    try:
        status = run(options, own.start if client else None)
    finally:
        own.end()
    return status or own.status


def _list() -> None:
    rows = examples()
    width = max(map(len, rows))
    for each in rows.values():
        _echo_row(f"{each.name:<{width}}", each.what)
    say("Run one: morse demo NAME. Copy it as a starting point: morse demo NAME --copy FOLDER")


def _echo_row(name: str, what: str) -> None:
    """A row of two columns; a terminal breaks the second one between words, a pipe gets whole lines."""
    columns = shutil.get_terminal_size().columns - len(name) - 2 if sys.stdout.isatty() else len(what)
    lines = textwrap.wrap(what, max(columns, _NARROWEST))
    echo(f"{name}  " + f"\n{'':<{len(name)}}  ".join(lines))


def _copy(demo: Example, folder: Path) -> None:
    target = folder / demo.name
    if target.exists():
        raise CommandError(f"'{target}' already exists: choose another folder.")
    shutil.copytree(demo.scene.parent, target, ignore=shutil.ignore_patterns("__pycache__"))
    say(f"Run it:    morse run {target / 'scene.py'}")
    say(f"Drive it:  python3 {target / 'client.py'}")


class _Client:
    """The client program of an example, in a separate process.

    Attributes:
        status: 1 if it failed, else 0.
    """

    def __init__(self, demo: Example, *, ends_the_simulation: bool) -> None:
        self._file = demo.client
        self._ends = ends_the_simulation
        self._process: subprocess.Popen[bytes] | None = None
        self._ended = False
        self.status = 0

    def start(self, simulation: Simulation) -> None:
        """Start the program when a page of the live view shows the scene; at once if there is no live view."""
        if simulation.options.view == "web":
            threading.Thread(target=self._start_with_a_page, args=[simulation], name="client", daemon=True).start()
        else:
            self._start(simulation)

    def _start_with_a_page(self, simulation: Simulation) -> None:
        view = cast("View", simulation.view)
        if not (simulation.options.open_browser and has_display()):
            say(f"Open {view.url}: the client starts when a page shows the scene.")
        while not self._ended and not view.drawn:
            time.sleep(_PAUSE)
        if not self._ended:
            self._start(simulation)

    def _start(self, simulation: Simulation) -> None:
        """Start the program, which gets the port of the simulation."""
        managers: list[object] = list(simulation.context.services.request_managers().values())
        port = next(manager.port for manager in managers if hasattr(manager, "port"))
        environment = {**os.environ, "MORSE_SOCKET_PORT": str(port), "PYTHONUNBUFFERED": "1"}
        # MORSE may run from a source tree that is not installed
        sources = str(Path(__file__).resolve().parents[2])
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [sources, os.environ.get("PYTHONPATH")]))
        self._process = subprocess.Popen(
            [sys.executable, str(self._file)],
            env=environment,
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        threading.Thread(target=self._wait, args=[simulation], name="client", daemon=True).start()

    def _wait(self, simulation: Simulation) -> None:
        assert self._process is not None
        _, errors = self._process.communicate()
        status = self._process.returncode
        # the end of the simulation takes the connection away from the client: that is not a failure of it
        if self._ended or simulation.context.stopping():
            return
        echo(errors.decode(errors="replace"), err=True, end="")
        self.status = 1 if status else 0
        if self._ends:
            simulation.stop()
        elif not status:
            say(f"The client has ended. Run it again: python3 {self._file}. Ctrl+C ends the simulation.")

    def end(self) -> None:
        """Terminate the program, if it is still running."""
        self._ended = True
        if self._process is None or self._process.poll() is not None:
            return
        self._process.terminate()
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
