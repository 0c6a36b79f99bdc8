"""A simulation in real time for `benchmarks.programs.flooded`; prints the numbers of its ports as JSON."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

from benchmarks.programs.loading import prepare
from benchmarks.programs.readers import service_port, stream_ports

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation


def main() -> None:
    """Serve until killed."""
    arguments = dict(word.split("=") for word in sys.argv[1:])
    simulation = prepare("ports", view=arguments["with"] == "view", **arguments)
    print(json.dumps(_numbers(simulation, arguments["with"])), flush=True)
    simulation.run()


def _numbers(simulation: Simulation, middleware: str) -> dict[str, Any]:
    streams = stream_ports(simulation)
    numbers = {"services": service_port(simulation), "pose": streams["robot.pose"], "motion": streams["robot.motion"]}
    for manager in simulation.context.stream_managers.values():
        if middleware == "yarp" and hasattr(manager, "ports"):
            for name, (_, address) in manager.ports._ports.items():
                numbers["in" if name.endswith("/in") else "out"] = address.port
        if middleware in ("rosbridge", "foxglove") and hasattr(manager, "backend"):
            numbers["web"] = manager.backend._hub.server.port
    if simulation.view is not None:
        numbers["web"] = int(simulation.view.url.split(":")[2].split("/")[0])
    return numbers


if __name__ == "__main__":
    main()
