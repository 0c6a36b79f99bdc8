"""Runs by Ray, on this machine or on a cluster."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from typing import TYPE_CHECKING, Any

from morse.many.pool import ONE_THREAD
from morse.system.ray_cluster import RayCluster

if TYPE_CHECKING:
    from collections.abc import Callable

#: how often Ray tries a pack whose node dies
_RETRIES = 2


class RayExecutor(Executor):
    """A `concurrent.futures.Executor` whose tasks are tasks of Ray.

    Args:
        address: see `RayCluster`.
        workers: number of processors of ``local``.

    Attributes:
        workers: number of processors of the cluster.

    Raises:
        ImportError, ConnectionError: see `RayCluster`.
    """

    def __init__(self, address: str = "auto", workers: int | None = None) -> None:
        self._cluster = RayCluster(address, workers)
        self.workers = self._cluster.processors
        self._functions: dict[Any, Any] = {}

    def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[Any]:
        """Run a function on the cluster."""
        if fn not in self._functions:
            environment = {"env_vars": ONE_THREAD}
            self._functions[fn] = self._cluster.ray.remote(fn).options(max_retries=_RETRIES, runtime_env=environment)
        future: Future[object] = self._functions[fn].remote(*args, **kwargs).future()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Disconnect, if this object has connected."""
        self._cluster.close()
