"""Selection of the backend."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.ros2.mapping import BACKENDS, INSTALL

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.rosmsgs.topics.backend import Backend

_CLASSES = {
    "rclpy": "morse.middleware.ros2.backends.ros_client.RclpyBackend",
    "cyclonedds": "morse.middleware.ros2.backends.cyclone.CycloneBackend",
}


def available() -> list[str]:
    """The backends whose packages are installed, in order of preference; none is imported."""
    return [name for name in BACKENDS if find_spec(name) is not None]


def make_backend(options: Mapping[str, Any]) -> Backend:
    """Join the domain.

    Args:
        options: ``backend`` (None for the first usable one), ``domain_id``, ``interface``.

    Raises:
        MorseMiddlewareError: no backend is installed, or it cannot join.
    """
    wanted = options["backend"]
    found = [wanted] if wanted is not None else available()
    failures = []
    for name in found:
        module, _, cls = _CLASSES[name].rpartition(".")
        try:
            made: Backend = getattr(import_module(module), cls)(options)
        except ImportError as error:
            failures.append(f"{name} cannot be imported: {error}")
        else:
            return made
    said = "; ".join(failures) or "neither rclpy nor cyclonedds is installed"
    raise MorseMiddlewareError(
        f"ros2: {said}. Source the set-up file of a ROS 2 installation (source /opt/ros/jazzy/setup.bash), or install "
        f"the backend without ROS: {INSTALL}"
    )
