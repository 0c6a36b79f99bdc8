"""Selection of the backend."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.ros2 import BACKENDS
from morse.system.extras import install

if TYPE_CHECKING:
    from morse.core.values import Options
    from morse.rosmsgs.topics.backend import Backend

_CLASSES = {
    "rclpy": "morse.middleware.ros2.backends.ros_client.RclpyBackend",
    "cyclonedds": "morse.middleware.ros2.backends.cyclone.CycloneBackend",
}


def available() -> list[str]:
    """The backends whose packages are installed, in order of preference; none is imported."""
    return [name for name in BACKENDS if find_spec(name) is not None]


def make_backend(options: Options) -> Backend:
    """Join the domain.

    Args:
        options: ``backend`` (None for the first usable one), ``domain_id``, ``interface``.

    Raises:
        MorseMiddlewareError: no backend is installed, or it cannot join.
    """
    option = options["backend"]
    names = [option] if option is not None else available()
    failures = []
    for name in names:
        module, _, cls = _CLASSES[name].rpartition(".")
        try:
            backend: Backend = getattr(import_module(module), cls)(options)
        except ImportError as error:
            failures.append(f"{name} cannot be imported: {error}")
        else:
            return backend
    reasons = "; ".join(failures) or "neither rclpy nor cyclonedds is installed"
    raise MorseMiddlewareError(
        f"ros2: {reasons}. Source the set-up file of a ROS 2 installation (source /opt/ros/jazzy/setup.bash), or "
        f"install the backend without ROS: {install('ros2')}"
    )
