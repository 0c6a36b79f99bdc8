"""One robot that waits for steps of a client; prints the ports of its services, motion and pose."""

from __future__ import annotations

from benchmarks.programs.loading import prepare
from benchmarks.programs.readers import service_port, stream_ports


def main() -> None:
    """Serve until killed."""
    simulation = prepare("arena")
    simulation.pause()
    ports = stream_ports(simulation)
    print(service_port(simulation), ports["r0.motion0"], ports["r0.pose0"], flush=True)
    simulation.run()


if __name__ == "__main__":
    main()
