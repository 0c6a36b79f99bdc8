"""MORSE, the Modular OpenRobots Simulation Engine.

::

    import morse

    with morse.load("scene.py", seed=3) as sim:
        sim.robot.motion.publish({"v": 1.0})
        sim.step(60)
        print(sim.robot.pose.data["x"])
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.eyes import Rays, Renderer
    from morse.launch.load import load
    from morse.many.batch import batch
    from morse.sensors.on_models import sensors_on
    from morse.simulation.simulation import Simulation
    from morse.version import __version__

__all__ = ["Rays", "Renderer", "Simulation", "__version__", "batch", "load", "sensors_on"]

#: where the names are: importing a part of MORSE, such as the builder, does not load the simulator
_PLACES = {
    "Rays": "morse.eyes",
    "Renderer": "morse.eyes",
    "batch": "morse.many.batch",
    "Simulation": "morse.simulation.simulation",
    "load": "morse.launch.load",
    "sensors_on": "morse.sensors.on_models",
    "__version__": "morse.version",
}


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'morse' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_PLACES[name]), name)
