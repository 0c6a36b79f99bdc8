"""``morse run``: simulate a scene."""

from __future__ import annotations

import ast
import contextlib
import logging
import math
import os
import re
import socket
import sys
from datetime import date
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from morse.builder.names.project_files import project_files
from morse.cli.messages import CommandError, say, sentence, warn
from morse.cli.scenes import resolve
from morse.core.clock import SLOWEST
from morse.core.reports import log
from morse.scene.image_workers import image_workers
from morse.system.regular_files import read_regular
from morse.system.variables import node_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from morse.cli.app import GlobalOptions
    from morse.simulation.options import RunOptions


# Arguments after the scene on the command line of ``morse run``: arguments of the script, or misplaced options.

#: names through which programs access their command line
_READERS = frozenset(
    {"argv", "orig_argv", "argparse", "getopt", "optparse", "absl", "click", "docopt", "fire", "typer", "tyro"}
)


def check_arguments(
    scene: Sequence[str], arguments: Sequence[str], script: Path, source_paths: Iterable[str], parameters: Iterable[Any]
) -> list[str] | None:
    """Return the words of a command line with options of ``morse run`` after the scene in their right order.

    They are options of the script instead, with a warning, if the script may read them itself.

    Args:
        scene: the words that name the scene.
        arguments: the words after the scene.
        script: the file of the scene.
        source_paths: directories of the packages of its project.
        parameters: parameters of ``morse run``.

    Returns:
        None if the order is right, or the options are those of the script.
    """
    takes_value = {name: not parameter.is_flag for parameter in parameters for name in _options_of(parameter)}
    options = [word for word in arguments if word.startswith("-")]
    own = [word for word in options if word.split("=")[0] in takes_value]
    if not options or _reads_arguments(script, [str(script.parent), *source_paths]):
        if own:
            warn(
                f"{', '.join(own)}: arguments after the scene are passed to the script; options of `morse run` have "
                "to be before the scene."
            )
        return None
    if own:
        before, after = _sorted(arguments, takes_value)
        return [*before, *scene, *after]
    warn(f"{', '.join(options)}: the script does not read its arguments, so this has no effect.")
    return None


def _options_of(parameter: Any) -> list[str]:
    return [name for name in (*parameter.opts, *parameter.secondary_opts) if name.startswith("-")]


def _sorted(arguments: Sequence[str], takes_value: dict[str, bool]) -> tuple[list[str], list[str]]:
    """The options of the command with their values, and the other words."""
    before: list[str] = []
    after: list[str] = []
    words = iter(arguments)
    for word in words:
        name, equals, _ = word.partition("=")
        if name not in takes_value:
            after.append(word)
            continue
        before.append(word)
        if takes_value[name] and not equals and (value := next(words, None)) is not None:
            before.append(value)
    return before, after


def _reads_arguments(script: Path, directories: list[str]) -> bool:
    """Whether a script, or a module that it imports from its project, may read the command line."""
    if script.suffix != ".blend":
        try:
            ast.parse(read_regular(script))
        except (OSError, SyntaxError, ValueError):
            return True  # the error is reported when the script is executed
    return any(
        _READERS.intersection(_names_in(node)) for tree in project_files(script, directories) for node in ast.walk(tree)
    )


def _names_in(node: ast.AST) -> Iterable[str]:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return (name,)
        case ast.Import(names=names):
            return [alias.name.partition(".")[0] for alias in names]
        case ast.ImportFrom(module=module, names=names):
            return [*(alias.name for alias in names), (module or "").partition(".")[0]]
    return ()


# all words after the scene belong to the script, even if they look like options
CONTEXT_SETTINGS = {"allow_interspersed_args": False}

_logger = logging.getLogger("morse.main")

#: maximum duration in simulated seconds: more than 30 years; a longer one is a typing error
_LONGEST = 1e9

VIEWS = ("none", "web", "studio")
_GEOMETRY = re.compile(r"\d+x\d+(\+-?\d+,-?\d+)?")


def command(
    context: typer.Context,
    scene: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE [ARGUMENTS]",
            help="A registered environment, and optionally a file in it (default: default.py); or the path of a scene "
            "script. All further arguments are given to the script.",
            show_default=False,
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option("--name", help="Name of this simulation node (default: $MORSE_NODE, else the name of the host)."),
    ] = None,
    geometry: Annotated[
        str | None, typer.Option("-g", "--geometry", metavar="WxH[+dx,dy]", help="Accepted for old scripts.")
    ] = None,
    headless: Annotated[bool, typer.Option("--headless", help="No live view.")] = False,
    view: Annotated[
        str | None, typer.Option("--view", metavar="none|web|studio", help="Kind of the live view.")
    ] = None,
    view_port: Annotated[
        int | None, typer.Option("--view-port", help="Port of the live view (0: any free one).")
    ] = None,
    view_token: Annotated[
        str | None, typer.Option("--view-token", help="Token that a browser on another host has to send.")
    ] = None,
    view_origin: Annotated[
        list[str] | None,
        typer.Option(
            "--view-origin",
            metavar="ORIGIN",
            help="Origin of another web page that may embed and control the live view, e.g. http://localhost:8080.",
            show_default=False,
        ),
    ] = None,
    edit_script: Annotated[
        bool,
        typer.Option(
            "--edit-script", help="Let the page change and run the script: anyone who has its address can run any code."
        ),
    ] = False,
    host: Annotated[
        str, typer.Option("--host", help="Address on which every server listens; 0.0.0.0 for all networks.")
    ] = "127.0.0.1",
    speed: Annotated[
        str | None,
        typer.Option("--speed", metavar="X|max", help="Simulated seconds per second, or as fast as possible."),
    ] = None,
    duration: Annotated[
        str | None, typer.Option("--duration", metavar="SECONDS", help="Stop after this simulated time, s.")
    ] = None,
    ticks: Annotated[
        int | None, typer.Option("--ticks", metavar="N", help="Stop after this number of ticks, instead of --duration.")
    ] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of all random numbers.")] = None,
    verbose: Annotated[bool, typer.Option("--verbose", help="List all services at the start.")] = False,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Treat each warning about the scene as an error, and --strict-commands."),
    ] = False,
    strict_commands: Annotated[
        bool,
        typer.Option(
            "--strict-commands", help="Treat unknown fields and wrong types in messages of clients as errors."
        ),
    ] = False,
    keep_going: Annotated[
        bool,
        typer.Option(
            "--keep-going", help="Exit with status 0 even if a fault has switched off a part of the simulation."
        ),
    ] = False,
    ros2: Annotated[
        bool, typer.Option("--ros2", help="Also connect all components to ROS 2: topics, frames, time.")
    ] = False,
    profile: Annotated[bool, typer.Option("--profile", help="Print at the end how much time each part took.")] = False,
    watch: Annotated[
        bool | None,
        typer.Option(
            "--watch/--no-watch",
            help="Reload models and components whose files change while the simulation runs (default: with the live "
            "view).",
            show_default=False,
        ),
    ] = None,
    record: Annotated[
        str | None,
        typer.Option("--record", metavar="FILE.mcap", help="Record the run: sensors, frames, log, inputs."),
    ] = None,
    keep_last: Annotated[
        float,
        typer.Option(
            "--keep-last", metavar="S", help="Simulated seconds before a failure that are saved to a file; 0 for none."
        ),
    ] = 30.0,
    record_only: Annotated[
        str | None,
        typer.Option(
            "--record-only",
            metavar="NAME[,NAME]",
            help="The sensors to record (default: all); none: only inputs and log.",
        ),
    ] = None,
    cameras_on: Annotated[
        str | None,
        typer.Option(
            "--cameras-on",
            metavar="N",
            help="Render camera images in N other processes; 'processes' for one on each processor; or 'ray://auto'.",
        ),
    ] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the live view in a browser.")] = True,
) -> int:
    """Run a simulation scene.

    The scene is an environment made by `morse create`, or the path of a scene script.

    The exit status is 0; 1 if the scene cannot be loaded or the run was aborted; 2 for a wrong command line; 3 if a
    component, a stream, a middleware or another part was switched off by a fault, or did not end: the last lines of the
    log name each with time, file and line.
    """
    check_geometry(geometry)
    length = Length.of(duration, ticks)
    resolved = resolve(scene or [])
    node = name or node_name()
    # scripts of several nodes read from it which node they describe
    os.environ["MORSE_NODE"] = node
    options = resolved.options(
        node_name=node,
        view=_view(headless, view),
        host=_host(host),
        view_token=_token(view_token),
        view_origins=_origins(view_origin or []),
        edit_script=edit_script,
        open_browser=browser,
        speed=parse_speed(speed),
        duration=length.seconds,
        ticks=length.ticks,
        seed=_seed(seed),
        profile=profile,
        keep_going=keep_going,
        strict=strict or strict_commands,
        on_warning="raise" if strict else "log",
        verbose=verbose,
        interfaces=["ros2"] if ros2 else [],
        record=_record(record),
        keep_last=_kept(keep_last),
        record_only=_names(record_only, record),
        cameras_on=_workers(cameras_on),
    )
    options.watch = options.view == "web" if watch is None else watch
    if view_port is not None:
        options.view_port = _port(view_port)
    if geometry is not None:
        say("The live view is a page in your browser: -g/--geometry has no effect on it.")
    words = list(scene or [])
    positionals = words[: len(words) - len(resolved.arguments)]
    right = check_arguments(positionals, resolved.arguments, resolved.script, resolved.source_paths, _options(context))
    if right is not None:
        return _run_again(context, right)
    log.setup(colors=color_scheme(context.obj))
    return _simulate(options)


def _run_again(context: typer.Context, words: list[str]) -> int:
    """Run with the options of other words, and with those of this command line that the words do not have."""
    with context.command.make_context("run", words, parent=context.parent) as again:
        for name, value in context.params.items():
            source = again.get_parameter_source(name)
            if source is None or source.name == "DEFAULT":
                again.params[name] = value
        return int(context.command.invoke(again))


def _workers(place: str | None) -> int | str | None:
    try:
        return None if place is None else image_workers(place)
    except ValueError as error:
        raise CommandError(str(error).replace("cameras_on", "--cameras-on", 1), 2) from None


def _leave(status: int) -> None:
    """End the process at once, without waiting for threads that do not end."""
    try:
        logging.shutdown()
        for stream in (sys.stdout, sys.stderr):
            # a signal within a write of the same stream finds it busy, which is a RuntimeError
            with contextlib.suppress(Exception):
                stream.flush()
    finally:
        os._exit(status)


def _options(context: typer.Context) -> list[object]:
    return [parameter for parameter in context.command.params if parameter.param_type_name == "option"]


def _simulate(options: RunOptions) -> int:
    # imported only now: other commands, and errors on this command line, should not wait for the simulator to load
    try:
        from morse.launch.run import run
        from morse.simulation.ending import threads_left

        status = run(options, leave=_leave)
        threads_left(status, _leave)
        return status
    except Exception as error:
        if isinstance(error, ImportError) and error.name == "mujoco":
            raise CommandError(sentence(error)) from None
        # programs that read the log wait for this marker, also after an error
        _logger.critical("[ERROR][MORSE] Uncaught exception, quit.", exc_info=True)
        return 1


def check_geometry(geometry: str | None) -> None:
    """Reject a value that is not ``WxH`` or ``WxH+dx,dy``."""
    if geometry is not None and not _GEOMETRY.fullmatch(geometry):
        raise CommandError(f"--geometry is WIDTHxHEIGHT or WIDTHxHEIGHT+dx,dy, e.g. 800x600; got '{geometry}'.", 2)


def color_scheme(options: GlobalOptions | None, today: date | None = None) -> str:
    """The colours of the log, from the global options (and the season)."""
    if options is None or not (options.color or options.reverse_color):
        return "mono"
    today = today or date.today()
    if (today.month, today.day) >= (12, 25):
        return "xmas"
    return "dark" if options.reverse_color else "bright"


def _view(headless: bool, view: str | None) -> str:
    if headless and view not in (None, "none"):
        raise CommandError(
            f"--headless disables the live view, and --view {view} enables it: use only one of them.", status=2
        )
    if headless:
        return "none"
    if view is None:
        return "web"
    if view not in VIEWS:
        raise CommandError(f"--view is one of {', '.join(VIEWS)}; got '{view}'.", status=2)
    return view


#: words for as fast as possible; `morse.load` takes ``math.inf``
_FASTEST = ("max", "inf")


def parse_speed(text: str | None) -> float | None:
    """The value of ``--speed``; None for the speed of the scene.

    Raises:
        CommandError: it is neither a speed nor ``max`` or ``inf``.
    """
    if text is None:
        return None
    if text in _FASTEST:
        return math.inf
    speed = _positive("--speed", text, "0.5, 2 or max")
    if speed < SLOWEST:
        raise CommandError(
            f"--speed is at least {SLOWEST:g}, got {text}; use 'pause' or 'step' to stop the clock.", status=2
        )
    return speed


class Length(NamedTuple):
    """How long a simulation runs.

    Attributes:
        seconds: simulated seconds, or None.
        ticks: number of ticks, or None; at most one of the two is given.
    """

    seconds: float | None
    ticks: int | None

    @classmethod
    def of(cls, duration: str | None, ticks: int | None) -> Length:
        """The length of two options.

        Raises:
            CommandError: a value is not valid, or both are given.
        """
        if duration is not None and ticks is not None:
            raise CommandError("--duration and --ticks both say when the simulation stops: give one of them.", 2)
        if ticks is not None and ticks < 1:
            raise CommandError(f"--ticks takes an integer of at least 1, such as 600; got {ticks}.", 2)
        return cls(None if duration is None else _duration(duration), ticks)


def _duration(text: str) -> float:
    seconds = _positive("--duration", text, "60 (simulated seconds)")
    if seconds > _LONGEST:
        raise CommandError(
            f"--duration takes at most {_LONGEST:g} simulated seconds, got {text}; without it the simulation runs "
            "until it is stopped.",
            2,
        )
    return seconds


def _positive(option: str, text: str, example: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (value > 0.0 and math.isfinite(value)):
        raise CommandError(f"{option} takes a number greater than 0, such as {example}; got '{text}'.", 2)
    return value


def _seed(seed: int | None) -> int | None:
    if seed is not None and seed < 0:
        raise CommandError(f"--seed takes an integer of at least 0; got {seed}.", status=2)
    return seed


def _port(port: int) -> int:
    if not 0 <= port <= 65535:
        raise CommandError(f"--view-port is a number from 1 to 65535, or 0 for any free port; got {port}.", status=2)
    return port


def _record(path: str | None) -> str | None:
    if path is None:
        return None
    if os.path.isfile(path):
        raise CommandError(f"--record: {path} already exists, and is not overwritten: choose another name.", 2)
    folder = os.path.dirname(os.path.abspath(path))
    if not path or os.path.isdir(path) or not os.path.isdir(folder):
        raise CommandError(f"--record takes the path of a file in an existing folder, e.g. run.mcap; got '{path}'.", 2)
    return path


def _kept(seconds: float) -> float:
    if not 0.0 <= seconds <= _LONGEST:
        raise CommandError(f"--keep-last takes simulated seconds, such as 30, or 0; got {seconds:g}.", 2)
    return seconds


def _names(names: str | None, record: str | None) -> list[str] | None:
    if names is None:
        return None
    if record is None:
        raise CommandError("--record-only selects the sensors for --record: give both.", 2)
    return [] if names == "none" else [name.strip() for name in names.split(",") if name.strip()]


def _token(token: str | None) -> str | None:
    if token is not None and not token.strip():
        raise CommandError("--view-token must not be empty: it protects the live view.", status=2)
    return token


def _origins(origins: list[str]) -> list[str]:
    if not origins:
        return []
    # imported only if this option is used
    from morse.core.clients.web_access import checked_origin

    try:
        return [checked_origin(one) for one in origins]
    except ValueError as error:
        raise CommandError(f"--view-origin: {error}.", status=2) from None


def _host(host: str) -> str:
    try:
        # an address on which no server can listen is rejected here, in one line, rather than by each server
        for family, kind, protocol, _, address in socket.getaddrinfo(host or "?", 0, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.bind(address)
    except (OSError, UnicodeError):
        raise CommandError(
            f"--host '{host}' is not an address of this machine: use 127.0.0.1 for this machine only, "
            "0.0.0.0 to listen on all its networks.",
            status=2,
        ) from None
    return host
