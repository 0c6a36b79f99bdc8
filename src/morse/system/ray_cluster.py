"""Connects to a cluster of Ray."""

from __future__ import annotations

import logging
from typing import Any

from morse.system.extras import install


class RayCluster:
    """A connection to a cluster.

    Args:
        address: ``auto`` for the cluster of this machine, ``ray://host:10001`` for another one, ``local`` for processes
            of this machine.
        processors: number of processors of ``local``; None for all.

    Attributes:
        ray: the module.
        processors: number of processors of the cluster.

    Raises:
        ImportError: Ray is not installed.
        ConnectionError: there is no cluster.
    """

    def __init__(self, address: str, processors: int | None = None) -> None:
        try:
            import ray
        except ImportError:
            raise ImportError(f"Ray is not installed: {install('ray')}") from None
        self.ray, self._starts = ray, not ray.is_initialized()
        if self._starts:
            options: dict[str, Any] = {"log_to_driver": False, "logging_level": logging.ERROR}
            if address == "local":
                options |= {"num_cpus": processors, "include_dashboard": False}
            ray.init(address=address, **options)
        resources: Any = ray.cluster_resources
        self.processors = max(1, int(resources().get("CPU", 1)))

    def close(self) -> None:
        """Disconnect, if this object has connected."""
        if self._starts:
            self._starts = False
            self.ray.shutdown()
