"""``morse doctor``: the plug-ins of this installation, what each needs, and the line that installs it."""

from __future__ import annotations

import platform
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.assets.formats import ModelFormat, as_format, why_left_out
from morse.core.classes.plugins import PluginError, entry_points, load, use_project_here
from morse.core.reports.printing import echo
from morse.middleware.registry import Middleware, as_middleware
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from importlib.metadata import EntryPoint

#: what the entry points of each group bring
_GROUPS = {
    "morse.middlewares": "middleware",
    "morse.formats": "model format",
    "morse.compatibility": "old scripts",
    "morse.components": "components",
    "morse.modifiers": "modifiers",
    "morse.kinds": "message kinds",
    "morse.ros_messages": "ROS messages",
    "morse.assets": "models",
    "morse.services": "services",
    "morse.checks": "check of scenes",
    "morse.environment": "method of the environment",
    "morse.commands": "command",
    "morse.tasks": "learning tasks",
}
#: groups whose entry points have to name objects of a class
_USES: dict[str, Callable[[object], object]] = {"morse.middlewares": as_middleware, "morse.formats": as_format}


@dataclass(frozen=True, slots=True)
class Plugin:
    """A plug-in of MORSE, of an installed package, or of the project that runs.

    Attributes:
        name: that of its entry point.
        brings: what it adds.
        place: the module or object that the entry point names.
        purpose: what it gives, in a few words.
        needs: the Python modules of others that it uses.
        lacks: what is missing, so that it cannot be used; empty if it can.
        install: the command that installs what is missing.
        is_broken: whether it cannot be loaded, or is left out.
    """

    name: str
    brings: str
    place: str
    purpose: str = ""
    needs: tuple[str, ...] = ()
    lacks: str = ""
    install: str = ""
    is_broken: bool = False

    def lines(self) -> Iterator[str]:
        """What a user reads about it."""
        purpose = f": {self.purpose}" if self.purpose else ""
        yield f"{self.name} ({self.brings}, {self.place}){purpose}"
        needs = f"needs {', '.join(self.needs)}" if self.needs else "needs nothing else"
        yield f"    {needs}; {self.lacks or 'ready'}"
        if self.lacks and self.install:
            yield f"    to install it: {self.install}"


def plugins() -> Iterator[Plugin]:
    """All plug-ins, by what they bring."""
    use_project_here()
    for group, brings in _GROUPS.items():
        for point in entry_points(group):
            yield _examined(point, brings)


def _examined(point: EntryPoint, brings: str) -> Plugin:
    try:
        found = load(point, _USES.get(point.group, lambda entry: entry))
    except PluginError as error:
        reason = f"cannot be loaded: {error}"
        return Plugin(point.name, brings, point.value, lacks=reason, is_broken=True)
    if isinstance(found, ModelFormat) and (why := why_left_out(point)):
        reason = f"is left out: {why}"
        return Plugin(point.name, brings, point.value, lacks=reason, is_broken=True)
    if not isinstance(found, Middleware):
        return Plugin(point.name, brings, point.value, getattr(found, "purpose", ""))
    missing = ", ".join(found.lacks())
    lacks = f"{missing} is not installed" if missing else ""
    return Plugin(point.name, brings, point.value, found.purpose, found.modules, lacks, found.how_to_install())


def version_lines() -> Iterator[str]:
    """The version of MORSE, of Python, and the plug-ins."""
    yield f"morse {__version__}"
    yield f"Python {platform.python_version()} ({sys.executable}), {platform.system()} on {platform.machine()}"
    for plugin in plugins():
        yield from plugin.lines()


def command() -> int:
    """List the plug-ins of this installation, what each needs, and the line that installs it.

    Plug-ins are those of MORSE, of installed packages and of the project in this folder. The status is 1 if one of them
    cannot be loaded, or is left out. `morse check` examines the installation itself.
    """
    echo("\n".join(version_lines()))
    return 1 if any(plugin.is_broken for plugin in plugins()) else 0
