"""``morse.load``: loads a simulation in this process."""

from __future__ import annotations

import contextlib
import logging
import math
import numbers
import os
import re
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.formats import is_model
from morse.core.classes.plugins import PluginError, entry_points
from morse.core.classes.plugins import load as load_plugin
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import closest, nearest, quoted
from morse.kernel import loading, threads
from morse.scene import Scene
from morse.scene.image_workers import image_workers
from morse.scene.scene_warnings import SceneWarning, about, scene_warnings
from morse.simulation.options import RunOptions
from morse.system import variables

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.physics.model.compile import Compiled
    from morse.simulation.simulation import Simulation

logger = logging.getLogger("morse.main")

#: see `load`
_LABEL = re.compile(r"[\w-]{0,40}")
_ON_FAILURE = ("deactivate", "raise")
_ON_WARNING = ("log", "raise")
_VIEWS = ("web", "studio", "none", None)
#: maximum number of warnings of one check; the log is to be read
_MOST_WARNINGS = 100


def load(
    scene: str | os.PathLike[str] | Callable[[], object] | Scene,
    *,
    seed: int | None = None,
    sockets: bool = False,
    interfaces: Sequence[str] = (),
    view: str | None = None,
    strict: bool = False,
    arguments: Sequence[str] = (),
    speed: float | None = None,
    host: str = "127.0.0.1",
    view_port: int = 0,
    view_token: str | None = None,
    view_origins: Sequence[str] = (),
    watch: bool = False,
    on_failure: str = "deactivate",
    on_warning: str = "log",
    record: str | os.PathLike[str] | None = None,
    keep_last: float = 0.0,
    cameras_on: int | str | None = None,
    file_label: str | None = "",
) -> Simulation:
    """Load a scene. Simulated time advances when `Simulation.step` or `Simulation.run` is called.

    The process is not modified: the modules of the project of the scene, ``sys.path`` and ``sys.argv`` are private to
    the simulation. Without ``sockets`` and ``view``, no thread or socket is created.

    Args:
        scene: path of a scene script or of a model of an environment, a function that builds a scene, or a `Scene`.
        seed: seed of all random numbers; None for the seed of the scene.
        sockets: whether to open the middlewares of the scene, and the services on the socket.
        interfaces: names of middlewares for all components of all robots, as with ``env.add_default_interface``;
            implies ``sockets``. Not for a `Scene`, which has its own interfaces.
        view: ``web`` for the live view, ``studio`` for the viewer of MuJoCo, None for no view.
        strict: whether an unknown or ill-typed field in a message of a client is an error.
        arguments: ``sys.argv[1:]`` of a scene script.
        speed: speed of `Simulation.run`, simulated seconds per second; ``math.inf`` for as fast as possible.
        host: address on which every server listens.
        view_port: port of the live view; 0 for any free port.
        view_token: token that a browser on another host has to send.
        view_origins: origins of other web pages that may embed and control the live view, such as
            ``http://localhost:8080``.
        watch: whether to reload models and components of the project that are saved while the simulation runs; this
            starts a thread.
        on_failure: effect of an error in a component, a modifier, a stream, an observer or a callback. ``deactivate``
            switches off this part alone and logs its file and line; ``raise`` also raises the error from
            `Simulation.step` or `Simulation.run`, after the tick.
        on_warning: ``log`` logs the warnings about the scene; ``raise`` raises an error that lists all of them, as
            ``morse run --strict`` does.
        record: path of a recording of the run; see `Simulation.record`.
        keep_last: simulated seconds before a failure that are kept and written when it happens, as with
            ``morse run --keep-last``.
        cameras_on: number of processes that render the images of cameras, ``processes`` for one on each processor, or
            ``ray://auto`` for the cluster of Ray of this machine; None for the value of the scene, which is 0 by
            default. The images are the same.
        file_label: what the names of files that streams write get before their suffix, such as ``-run7``, so that
            several simulations do not write the same file; None to write no such files.

    Raises:
        FileNotFoundError: the file does not exist.
        ScriptError: the scene script has an error; the message contains the line.
        LoadError: a component cannot be created.
        SceneWarningError: with ``on_warning="raise"``, the scene has warnings.
        ValueError: the physics of the scene cannot be compiled, or an option has an invalid value.
        TypeError: an option has the wrong type.
    """
    _check(seed, view, arguments, speed, view_port)
    _check_word("on_failure", on_failure, _ON_FAILURE)
    _check_word("on_warning", on_warning, _ON_WARNING)
    if file_label is not None and not (isinstance(file_label, str) and _LABEL.fullmatch(file_label)):
        raise ValueError(
            f"file_label is a part of the name of a file, up to 40 letters, digits, '_' and '-', not {file_label!r:.80}"
        )
    if isinstance(keep_last, bool) or not isinstance(keep_last, numbers.Real) or not 0.0 <= float(keep_last) < math.inf:
        raise ValueError(f"keep_last is a number of simulated seconds, not {keep_last!r:.80}")
    options = RunOptions(
        arguments=list(arguments),
        sockets=sockets or bool(interfaces),
        interfaces=list(interfaces),
        view=view or "none",
        host=host,
        view_port=view_port,
        view_token=view_token,
        view_origins=_origins(view_origins),
        open_browser=False,
        speed=speed,
        seed=None if seed is None else int(seed),
        strict=strict,
        watch=watch,
        on_failure=on_failure,
        on_warning=on_warning,
        record=None if record is None else os.fspath(record),
        keep_last=float(keep_last),
        cameras_on=None if cameras_on is None else image_workers(cameras_on),
        file_label=file_label,
    )
    with scene_warnings(refused=on_warning == "raise"):
        simulation = start(described(scene, options), options)
    if simulation.view is not None:
        simulation.view.announce()
    return simulation


def _check_word(name: str, word: object, words: tuple[str, str]) -> None:
    if word not in words:
        raise ValueError(f"{name} is '{words[0]}' or '{words[1]}', not {quoted(word)}{nearest(word, words)}")


def _origins(origins: Any) -> list[str]:
    if isinstance(origins, str) or not all(isinstance(one, str) for one in origins):
        raise TypeError(f"view_origins is a list of strings, not {origins!r:.80}")
    if not origins:
        return []
    # imported only if this option is used
    from morse.core.clients.web_access import checked_origin

    try:
        return [checked_origin(one) for one in origins]
    except ValueError as error:
        raise ValueError(f"view_origins: {error}") from None


def _check(seed: object, view: object, arguments: Any, speed: object, view_port: object) -> None:
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, numbers.Integral)):
        raise TypeError(f"seed is an integer or None, not {seed!r:.80}")
    if view not in _VIEWS:
        raise ValueError(f"view is 'web', 'studio' or None, not {view!r:.80}")
    if isinstance(arguments, str) or not all(isinstance(argument, str) for argument in arguments):
        raise TypeError(f"arguments is a list of strings, not {arguments!r:.80}")
    if speed is not None and (isinstance(speed, bool) or not isinstance(speed, numbers.Real)):
        raise TypeError(f"speed is a number or None, not {speed!r:.80}")
    if speed is not None and not float(speed) > 0.0:
        raise ValueError(f"speed is a positive number of simulated seconds per second, not {speed!r:.80}")
    if isinstance(view_port, bool) or not isinstance(view_port, numbers.Integral):
        raise TypeError(f"view_port is an integer, not {view_port!r:.80}")
    if not 0 <= int(view_port) <= 65535:
        raise ValueError(f"view_port is a TCP port from 0 to 65535, not {view_port}")


def described(scene: str | os.PathLike[str] | Callable[[], object] | Scene, options: RunOptions) -> Scene:
    """The scene of an argument; a `Scene` is copied, because simulations modify theirs.

    Raises:
        FileNotFoundError: the file does not exist.
        ScriptError: the scene script has an error.
        TypeError: the argument does not describe a scene.
    """
    if isinstance(scene, Scene):
        return scene.copy()
    from morse.builder.script import build, load_scene

    if callable(scene):
        name = f"the function {getattr(scene, '__qualname__', scene)}"
        return build(scene, name, interfaces=options.interfaces, nearby=_folders_of(scene))
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"a scene is a path, a function that builds a scene, or a morse.scene.Scene, not {scene!r:.80}")
    script = Path(scene).absolute()
    if not script.is_file():
        near = closest(script.name, _names_beside(script))
        hint = f"; did you mean '{near}'?" if near is not None else ""
        raise FileNotFoundError(f"the scene script {script} does not exist{hint}")
    options.script = str(script)
    for folder, paths in (("src", options.source_paths), ("data", options.resource_paths)):
        # a model that is run as a scene is data: it brings no code
        if not paths and (script.parent / folder).is_dir() and not (folder == "src" and is_model(script)):
            paths.append(str(script.parent / folder))
    return load_scene(options)


def _names_beside(script: Path) -> list[str]:
    """The names of scripts and models in the folder of a scene."""
    try:
        return [path.name for path in script.parent.iterdir() if path.suffix == ".py" or is_model(path)]
    except OSError:
        return []


def _folders_of(function: Callable[[], object]) -> list[str]:
    """The folders of models of the project that contains a function."""
    from morse.builder.names.project_files import resource_folders

    code = getattr(function, "__code__", None)
    return resource_folders(Path(code.co_filename)) if code is not None and os.path.isfile(code.co_filename) else []


def start(scene: Scene, options: RunOptions, compiled: Compiled | None = None) -> Simulation:
    """A simulation of a scene, ready to run.

    Args:
        compiled: the physics of the scene, whose collision shapes are resolved; None to compile it.

    Raises:
        LoadError: a component cannot be created.
        ValueError: the physics of the scene cannot be compiled.
        OSError: a port is not available.
    """
    from morse.simulation.simulation import Simulation

    review_settings()
    with scene_warnings(refused=options.on_warning == "raise"), about(scene.where):
        if compiled is None:
            resolve(scene)
        simulation = Simulation(scene, options, compiled)
        try:
            complete(simulation)
        except BaseException:
            simulation.close()
            raise
    return simulation


def review_settings() -> None:
    """Log a warning for each environment variable of MORSE that is misspelt or has an invalid value."""
    variables.review()
    # both warn about their own variables, when they are first called
    threads.count()
    with contextlib.suppress(loading.KernelError):  # the world that is created says so
        loading.library()


def resolve(scene: Scene) -> None:
    """Compute the collision shapes of a scene, and log warnings."""
    from morse.assets.collision import warnings_of_shapes

    for node, warning in warnings_of_shapes(scene):
        logger.warning("%s", warning, extra={"where": node.line or scene.where})


class SceneWarningError(MorseError):
    """A scene has warnings, and is to have none.

    Attributes:
        warnings: all of them.
    """

    def __init__(self, warnings: Sequence[SceneWarning]) -> None:
        self.warnings = tuple(warnings)
        count = "a warning, which is" if len(warnings) == 1 else f"{len(warnings)} warnings, which are"
        super().__init__("\n  ".join([f"the scene has {count} refused (--strict):", *map(str, warnings)]))


def refuse(warnings: Sequence[SceneWarning]) -> None:
    """Raise the error for warnings that are refused, if there are any.

    Raises:
        SceneWarningError: there are.
    """
    if warnings:
        raise SceneWarningError(warnings)


def complete(simulation: Simulation) -> None:
    """Create the components, and start the live view, file watching and recording according to the options.

    Raises:
        LoadError: a component cannot be created.
        SceneWarningError: the scene has warnings, and is to have none.
        RecordingError: the recording cannot be written.
        OSError: the live view cannot be opened.
    """
    from morse.physics.model.placement import below_the_floor, overlaps, raised
    from morse.simulation.reviews import Fallen, PublishedData

    with scene_warnings(refused=simulation.options.on_warning == "raise") as collected, about(simulation.scene.where):
        simulation.load()
        serious, others = overlaps(simulation.world)
        for message, where in (serious, raised(simulation.world), below_the_floor(simulation.world)):
            if message:
                logger.warning("%s", message, extra={"where": where})
        if others:
            logger.info("%s", others)
        _log_warnings_of_packages(simulation.scene)
        refuse(collected.complete())
    if simulation.options.view != "none":
        from morse.viewer.opening import open_view

        simulation.view = open_view(simulation)
        simulation.observers.append(simulation.view)
    if simulation.options.watch:
        from morse.simulation.watching.watch import Watch

        simulation.observers.append(Watch(simulation))
    simulation.reviews.extend((PublishedData(simulation).review, Fallen(simulation).review))
    options = simulation.options
    if options.keep_last:
        from morse.simulation.recordings.recorders import FlightRecorder

        simulation.flight_recorder = FlightRecorder(simulation, options.keep_last)
        simulation.observers.append(simulation.flight_recorder)
    if options.record is not None:
        simulation.record(options.record, options.record_only)
        # if an edited scene replaces this one, it has a separate recording
        options.record = next_name(options.record)


def _log_warnings_of_packages(scene: Scene) -> None:
    """Log what the checks of packages find in a complete scene; a check that fails is named, and the others go on.

    A package names a function, which gets the scene and returns `morse.scene.SceneWarning` objects, by an entry point::

        [project.entry-points."morse.checks"]
        masses = "my_lab.checks:heavy_props"
    """
    with scene.project:
        for point in entry_points("morse.checks"):
            try:
                load_plugin(point, lambda check: _log(check(scene)))
            except PluginError as error:
                logger.warning("the check '%s' (%s) cannot be made: %s", point.name, point.value, error)


def _log(warnings: Iterable[object] | None) -> None:
    if warnings is None or isinstance(warnings, str):
        raise TypeError(f"it returns {warnings!r:.80}, expected morse.scene.SceneWarning objects: a list, or 'yield'")
    for warning in islice(warnings, _MOST_WARNINGS):
        if not isinstance(warning, SceneWarning):
            raise TypeError(f"it returns {warning!r:.80}, expected objects of morse.scene.SceneWarning")
        logger.warning("%s", warning.message, extra={"where": warning.where, "is_old": warning.is_old})


def next_name(path: str) -> str:
    """Return the path with the first free number: ``run-2.mcap`` for ``run.mcap``."""
    stem, suffix = os.path.splitext(path)
    number = 2
    while os.path.exists(f"{stem}-{number}{suffix}"):
        number += 1
    return f"{stem}-{number}{suffix}"
