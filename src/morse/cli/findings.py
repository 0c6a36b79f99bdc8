"""Detects required and optional software on this machine."""

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
from typing import TYPE_CHECKING

from morse.assets.search import MORSE_COMPONENTS
from morse.cli import blender
from morse.kernel import loading
from morse.middleware import registry
from morse.middleware.ros2.backends.choice import available
from morse.system import extras
from morse.system.extras import REINSTALL, install

if TYPE_CHECKING:
    from collections.abc import Iterator

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
