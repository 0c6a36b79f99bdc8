"""What this machine has that MORSE needs or can use."""

from __future__ import annotations

import ctypes.util
import importlib
import importlib.metadata
import importlib.util
import os
import platform
import sys
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.search import MORSE_COMPONENTS
from morse.cli import blender

if TYPE_CHECKING:
    from collections.abc import Iterator

_MINIMAL_PYTHON = (3, 11)

_REQUIRED_MODULES = {
    "mujoco": ("mujoco-core", "physics"),
    "numpy": ("numpy", "arrays"),
    "msgspec": ("msgspec", "messages of the socket"),
    "websockets": ("websockets", "the live view"),
    "zstandard": ("zstandard", "reading .blend files"),
    "mapbox_earcut": ("mapbox-earcut", "meshes with polygons"),
}

_MIDDLEWARES = {
    "ROS 1": ("ros", "rospy", "source /opt/ros/noetic/setup.bash, or sudo apt-get install python3-rospy"),
    "ROS 2": ("ros2", "rclpy", "source /opt/ros/<distribution>/setup.bash, after an installation from https://ros.org"),
    "YARP": ("yarp", "yarp", "conda install -c conda-forge yarp"),
    "MOOS": ("moos", "pymoos", "pip install pymoos"),
    "MAVLink": ("mavlink", "pymavlink", "pip install pymavlink"),
}


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked for.

    Attributes:
        name: as the user knows it.
        found: whether it is there and works.
        detail: version or place, or what is wrong.
        gives: what it is for.
        install: how to get it; empty if it would be of no use.
        required: MORSE does not run without it.
    """

    name: str
    found: bool
    detail: str
    gives: str
    install: str
    required: bool = False


def findings() -> Iterator[Finding]:
    """Look for everything, the required things first."""
    yield _python()
    for module, (distribution, purpose) in _REQUIRED_MODULES.items():
        yield _module(module, distribution, purpose, f"pip install {distribution}", required=True)
    yield _data()
    yield _module("embreex", "embreex", "laser scanners up to 25 times faster", "pip install embreex")
    yield _browser()
    yield _graphics()
    yield _blender()
    for name, (middleware, module, install) in _MIDDLEWARES.items():
        yield _middleware(name, middleware, module, install)


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
    except Exception as error:  # a broken binary package fails in its own way
        return Finding(module, False, f"{type(error).__name__}: {error}", gives, install, required)
    return Finding(module, True, detail, gives, install, required)


def _data() -> Finding:
    wanted = Path(MORSE_COMPONENTS, "environments", "sandbox.blend")
    found = wanted.is_file()
    detail = MORSE_COMPONENTS if found else f"{wanted} is missing"
    return Finding(
        "MORSE data",
        found,
        detail,
        "robots, environments, props",
        "pip install --force-reinstall morse-simulator",
        True,
    )


def _browser() -> Finding:
    gives = "the live view opens by itself (else: open the address that `morse run` prints)"
    install = "sudo apt-get install firefox-esr"
    if sys.platform not in ("win32", "darwin") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return Finding(
            "Display and browser", False, "no display (DISPLAY, WAYLAND_DISPLAY)", gives, "a desktop session"
        )
    try:
        return Finding("Display and browser", True, webbrowser.get().__class__.__name__, gives, install)
    except webbrowser.Error as error:
        return Finding("Display and browser", False, str(error), gives, install)


def _graphics() -> Finding:
    gives = "camera images drawn by the graphics card (else: ray-cast, slower)"
    install = "sudo apt-get install libegl1 libgl1"
    if sys.platform in ("win32", "darwin"):
        return Finding("OpenGL", True, "part of the system", gives, install)
    libraries = {name: ctypes.util.find_library(name) for name in ("EGL", "GL", "OSMesa")}
    detail = ", ".join(library for library in libraries.values() if library)
    # EGL alone does not do: its functions for drawing are those of libGL
    found = bool((libraries["EGL"] and libraries["GL"]) or libraries["OSMesa"])
    return Finding("OpenGL", found, detail or "no libEGL with libGL, no libOSMesa", gives, install)


def _blender() -> Finding:
    program, where = blender.find()
    gives = "editing models and environments; models that use modifiers, curves or bone parents"
    if program is None:
        return Finding("Blender", False, where, gives, blender.INSTALL)
    version = blender.version(program)
    return Finding("Blender", version.startswith("Blender"), f"{version} ({where})", gives, blender.INSTALL)


def _middleware(name: str, middleware: str, module: str, install: str) -> Finding:
    found = _exists(module)
    detail = f"module {module}" if found else f"no module {module}"
    if _exists(f"morse.middleware.{middleware}"):
        return Finding(name, found, detail, f"streams and services over {name}: add_stream('{middleware}')", install)
    return Finding(name, found, detail, "nothing: this version of MORSE does not speak it", "")


def _exists(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False
