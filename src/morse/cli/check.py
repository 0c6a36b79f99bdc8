"""``morse check``: report installed and missing requirements."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import os
import platform
import re
import sys
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.table import Table
from rich.text import Text

from morse.assets import search
from morse.assets.formats import suffixes
from morse.assets.search import MORSE_COMPONENTS
from morse.cli import blender
from morse.cli.check_files import check_model, check_scene
from morse.cli.messages import CommandError, existing_file, nearest, say, sentence
from morse.cli.sites import Sites
from morse.core.reports import printing
from morse.core.reports.printing import echo
from morse.kernel import loading
from morse.middleware import registry
from morse.middleware.ros2.domain import available
from morse.system import extras
from morse.system.extras import REINSTALL, install
from morse.system.regular_files import expanded
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.verification.contract import Report


# Detects required and optional software on this machine.

_MINIMAL_PYTHON = (3, 11)
#: directory of the Python packages of Debian and Ubuntu
_DEBIAN = "/usr/lib/python3/dist-packages"

_REQUIRED_MODULES = {
    "mujoco": ("mujoco-core", "physics"),
    "numpy": ("numpy", "arrays"),
    "msgspec": ("msgspec", "messages of the socket"),
    "websockets": ("websockets", "the live view"),
    "zstandard": ("zstandard", "reading .blend files"),
    "mapbox_earcut": ("mapbox-earcut", "meshes with polygons"),
}


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check.

    Attributes:
        name: name for the user.
        found: whether it is installed and works.
        detail: version or location, or a description of the problem.
        gives: its purpose.
        install: how to install it; empty if that would be of no use.
        required: whether MORSE requires it.
    """

    name: str
    found: bool
    detail: str
    gives: str
    install: str
    required: bool = False


def findings() -> Iterator[Finding]:
    """Run all checks, required software first."""
    yield _python()
    for module, (distribution, purpose) in _REQUIRED_MODULES.items():
        yield _module(module, distribution, purpose, f"pip install {distribution}", required=True)
    yield from _two_mujocos()
    yield _data()
    yield _kernel()
    yield _ros2()
    yield from _middlewares()
    yield _browser()
    yield _blender()


def _python() -> Finding:
    return Finding(
        "Python",
        sys.version_info >= _MINIMAL_PYTHON,
        f"{platform.python_version()} ({sys.executable})",
        "everything",
        f"Python {'.'.join(map(str, _MINIMAL_PYTHON))} or later: https://www.python.org",
        required=True,
    )


def _module(module: str, distribution: str, gives: str, install: str, *, required: bool = False) -> Finding:
    try:
        importlib.import_module(module)
        detail = importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return Finding(module, True, "of unknown version", gives, install, required)
    except ModuleNotFoundError as error:
        # a package that is there, but lacks one of its own, names that one
        lacks = error.name not in (None, module, module.partition(".")[0])
        return Finding(module, False, str(error) if lacks else "not installed", gives, install, required)
    except Exception as error:  # a broken binary package may raise any exception
        return Finding(module, False, f"{type(error).__name__}: {error}", gives, install, required)
    return Finding(module, True, detail, gives, install, required)


def _two_mujocos() -> Iterator[Finding]:
    """A MuJoCo that is complete in one package, before 4.0, shares its folder with that of `mujoco-core`."""
    try:
        whole, core = importlib.metadata.version("mujoco"), importlib.metadata.version("mujoco-core")
    except importlib.metadata.PackageNotFoundError:
        return
    if whole.split(".", 1)[0] != core.split(".", 1)[0]:
        yield Finding(
            "one MuJoCo",
            False,
            f"mujoco {whole} and mujoco-core {core} have overwritten each other's files",
            "physics",
            "pip uninstall -y mujoco mujoco-core, then pip install mujoco-core; what needs the other one, into another "
            "environment",
            required=True,
        )


def _kernel() -> Finding:
    try:
        found, detail = True, Path(loading.library()._name).name
    except loading.KernelError as error:
        found, detail = False, str(error)
    return Finding(
        "native kernel",
        found,
        detail,
        "rays, camera images, driven robots",
        REINSTALL,
        required=True,
    )


def _ros2() -> Finding:
    implementations = available()
    gives = "topics of ROS 2"
    if "rclpy" in implementations:
        gives = "topics, services and actions of ROS 2"
        if importlib.util.find_spec("simulation_interfaces") is not None:
            implementations = [*implementations, "simulation_interfaces"]
    return Finding(
        "ROS 2",
        bool(implementations),
        ", ".join(implementations) or "neither rclpy nor cyclonedds",
        gives,
        install("ros2"),
    )


def _middlewares() -> Iterator[Finding]:
    """What middlewares need of others, and say how to install."""
    for entry in registry.installed().values():
        if entry.modules and entry.how_to_install():
            yield _middleware(entry)


def _middleware(entry: registry.Middleware) -> Finding:
    module = entry.modules[0]
    if importlib.util.find_spec(module) is None and Path(_DEBIAN, module).is_dir():
        # a virtual environment does not see the packages of the system
        mend = f"python3 -m venv --system-site-packages, or add {_DEBIAN} to PYTHONPATH"
        return Finding(module, False, f"{module} of Debian, which {sys.prefix} does not see", entry.purpose, mend)
    packages = extras.packages(entry.extra) if entry.extra else []
    distribution = re.split(r"[<>=~! ]", (packages or [module])[0])[0]
    return _module(module, distribution, entry.purpose, entry.how_to_install())


def _data() -> Finding:
    file = Path(MORSE_COMPONENTS, "environments", "sandbox.blend")
    exists = file.is_file()
    detail = MORSE_COMPONENTS if exists else f"{file} is missing"
    return Finding(
        "MORSE data",
        exists,
        detail,
        "robots, environments, props",
        REINSTALL,
        True,
    )


def _browser() -> Finding:
    gives = "opens the live view by itself; else open the address that `morse run` prints"
    install = "sudo apt-get install firefox-esr"
    if sys.platform not in ("win32", "darwin") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return Finding(
            "Display and browser", False, "no display (DISPLAY, WAYLAND_DISPLAY)", gives, "a desktop session"
        )
    try:
        return Finding("Display and browser", True, webbrowser.get().__class__.__name__, gives, install)
    except webbrowser.Error as error:
        return Finding("Display and browser", False, str(error), gives, install)


def _blender() -> Finding:
    program, where = blender.find()
    gives = "editing models and environments; models that use modifiers, curves or bone parents"
    if program is None:
        return Finding("Blender", False, where, gives, blender.INSTALL)
    version = blender.version(program)
    return Finding("Blender", version.startswith("Blender"), f"{version} ({where})", gives, blender.INSTALL)


_USAGE = (
    "Give names or files: `morse check component Pose`, `morse check component my_sim/src/my_sim/sensors/sonar.py`."
)


def check_components(names: Sequence[str], robot: str | None) -> int:
    """Check components and print a report of each.

    Args:
        names: classes of scene scripts, or files.
        robot: class of the robot for the components.

    Returns:
        The exit status: 1 if a component breaks a rule.

    Raises:
        CommandError: no component was given.
    """
    if not names:
        raise CommandError(f"Which component? {_USAGE}", status=2)
    # imported on demand, because it loads the simulator
    from morse.verification.contract import SubjectError, check_component

    success = True
    for name in names:
        try:
            reports = check_component(name, robot)
        except SubjectError as error:
            raise CommandError(sentence(error)) from None
        for report in reports:
            _print(report)
            success &= report.passed
    return 0 if success else 1


def _print(report: Report) -> None:
    carrier = f", on {report.robot}" if report.robot and report.robot != report.name else ""
    echo(f"{report.name}{carrier}{f' ({report.where})' if report.where else ''}")
    for rule in report.checked:
        faults = report.of(rule)
        echo(f"  {'NO ' if faults else 'yes'} {rule}")
        for fault in faults:
            echo(f"      {fault.where or report.name}: {fault.text}")
    say(f"{report.name} satisfies the contract." if report.passed else f"{report.name}: {_count(len(report.faults))}.")


def _count(faults: int) -> str:
    return "1 fault" if faults == 1 else f"{faults} faults"


#: characters of a line that has room for the columns of the table
_WIDTH_OF_TABLE = 72


def command(
    what: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE | MODEL | component FILE_OR_NAME",
            help="A scene script or environment: list what needs a change, and whether it runs. A model file: what is "
            "read, what is left out, and a picture. Or components: classes of scene scripts, or files with classes of "
            "your own.",
            show_default=False,
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            "--robot",
            metavar="CLASS",
            help="Robot for the components: a robot of MORSE, or package.module.Class of the project.",
        ),
    ] = None,
    fix: Annotated[
        bool, typer.Option("--fix", help="Write a corrected copy beside the scene script, which itself is not changed.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Treat each warning about the scene or model as an error: status 1.")
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            "--picture",
            metavar="FILE.png",
            help="The picture of a model file (default: MODEL_check.png in the present folder).",
            show_default=False,
        ),
    ] = None,
) -> int:
    """Check the requirements of MORSE and optional programs; or a scene script; or components.

    `morse check SCENE` executes a scene script, lists all lines that need a change, e.g. since MORSE 1.4, and ends with
    "runs" or "does not run". The exit status is 1 for errors; with --strict, also for warnings and old forms. `morse
    check MODEL` lists the content of a model file, and draws it. `morse check component NAME` runs a component in small
    simulations and reports violated rules of the contract.
    """
    if strict and (not what or what[0] == "component"):
        raise CommandError("--strict belongs to `morse check SCENE` and `morse check MODEL`.", status=2)
    if what and what[0] == "component":
        return check_components(what[1:], robot)
    if what:
        return _check_scene(what, fix=fix, strict=strict, picture=picture)
    if fix:
        raise CommandError("--fix belongs to `morse check SCENE`.", status=2)
    if robot is not None:
        raise CommandError("--robot belongs to `morse check component FILE_OR_NAME...`.", status=2)
    echo(f"MORSE {__version__}")
    results = list(findings())
    console = printing.console()
    if console.width < _WIDTH_OF_TABLE:
        for result in results:  # columns would cut words
            console.print(_mark(result), f"{result.name}: {result.detail}", highlight=False, markup=False)
    else:
        console.print(_table(results))
    say(f"Available middlewares: {', '.join(registry.installed())}.")
    _say_places()
    problems = [result for result in results if result.required and not result.found]
    for result in problems:
        say(f"Missing: {result.name} ({result.detail}). To install it: {result.install}")
    for result in results:
        if not result.found and not result.required and result.install:
            say(f"Optional: {result.name} ({result.gives}): {result.install}")
    if problems:
        raise typer.Exit(1)
    say("All requirements of MORSE are met.")
    return 0


def _check_scene(words: list[str], *, fix: bool, strict: bool, picture: Path | None) -> int:
    model = _model(words[0])
    if model is not None:
        return check_model(model, picture, strict=strict)
    if picture is not None:
        raise CommandError("--picture belongs to `morse check MODEL`; `morse render` draws scenes.", status=2)
    try:
        return check_scene(words, fix=fix, strict=strict)
    except CommandError as error:
        hint = nearest(words[0], ["component"])
        raise CommandError(f"{error}{hint}") if hint else error from None


def _model(name: str) -> Path | None:
    """The model file of that name, or in a folder of that name; None for a script or an environment."""
    path = expanded(name)
    if path.is_dir():
        from morse.assets.gazebo.values import CONFIG, model_file

        return model_file(path) if (path / CONFIG).is_file() else None
    if path.suffix.lower() not in suffixes():
        return None
    return existing_file(path)


def _table(results: list[Finding]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("", "What", "Found", "Gives"):
        table.add_column(heading)
    for result in results:
        table.add_row(_mark(result), result.name, Text(result.detail, overflow="fold"), Text(result.gives))
    return table


def _mark(result: Finding) -> Text:
    if result.found:
        return Text("yes", style="green")
    return Text("NO", style="bold red") if result.required else Text("no", style="yellow")


def _say_places() -> None:
    """Print the directories of data, each on a separate line, for copying."""
    own, *others = search.component_dirs()
    say(f"MORSE data directory: {own}")
    for name, directories in (("MORSE_ROOT", others), ("MORSE_RESOURCE_PATH", search.resource_dirs())):
        for path in directories:
            say(f"Searched as well ({name}): {path}" + ("" if path.is_dir() else ", which does not exist"))
    sites = Sites()
    say(f"Configuration: {sites.path}. {sites.known()}")
