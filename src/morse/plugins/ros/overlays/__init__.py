"""Actions of ROS 1 for components, at the class paths of MORSE 1.4."""

from __future__ import annotations

from importlib import import_module

from morse.core.exceptions import MorseMiddlewareError

_OF_DEBIAN = ("move_base_msgs",)


def action_type(name: str, *packages: str) -> object:
    """The class of an action, from the first of some packages of messages that is installed.

    Raises:
        MorseMiddlewareError: none of them is installed.
    """
    for package in packages:
        try:
            return getattr(import_module(f"{package}.msg"), name)
        except (ImportError, AttributeError):
            continue
    raise MorseMiddlewareError(
        f"ros: the action {name} is in {' and in '.join(packages)}, which cannot be imported. Install one of them: "
        + " or ".join(map(_install, packages))
    )


def _install(package: str) -> str:
    name = package.replace("_", "-")
    # Debian has only a few packages of messages; the others come with ROS
    return f"sudo apt install {'python3' if package in _OF_DEBIAN else 'ros-noetic'}-{name}"
