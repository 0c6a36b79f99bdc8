"""Workers on a cluster of Ray, which receive the scene and the poses, and answer with images."""

from __future__ import annotations

from typing import Any

from morse.kernel import threads
from morse.rendering.workers.easel import Easel
from morse.scene.image_workers import RAY
from morse.system.ray_cluster import RayCluster
from morse.system.worker_process import PATIENCE


class RayCrew:
    """The connection to a cluster, and its workers.

    Args:
        place: ``ray://auto``, ``ray://local`` or ``ray://host:port``.

    Raises:
        ImportError, ConnectionError: see `RayCluster`.
    """

    def __init__(self, place: str) -> None:
        address = place.removeprefix(RAY)
        self._cluster = RayCluster(address if address in ("auto", "local") else place)
        self.count = self._cluster.processors

    def hire(self) -> RayWorker:
        """Start a worker."""
        return RayWorker(self._cluster.ray)

    def close(self) -> None:
        """Disconnect."""
        self._cluster.close()


class RayWorker:
    """An actor that draws with one thread, on any node.

    Args:
        ray: the module.
    """

    def __init__(self, ray: Any) -> None:
        self._ray = ray
        environment = {"env_vars": {threads.VARIABLE: "1"}}
        self._easel = ray.remote(Easel).options(num_cpus=1, runtime_env=environment).remote()

    def ask(self, message: bytes) -> bytes:
        """Send a message and wait for the answer.

        Raises:
            EOFError: the actor or its node has ended, or does not answer.
        """
        errors = self._ray.exceptions
        try:
            answer: bytes = self._ray.get(self._easel.answer.remote(message), timeout=PATIENCE)
        except (errors.RayActorError, errors.GetTimeoutError) as error:
            raise EOFError(str(error)) from None
        return answer

    def close(self) -> None:
        """End the actor."""
        self._ray.kill(self._easel)
