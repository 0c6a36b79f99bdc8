"""Runs by Ray, on this machine or on a cluster."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from typing import TYPE_CHECKING, Any

from morse.many.pool import ONE_THREAD

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import Options

#: how often Ray tries a pack whose node dies
_RETRIES = 2


class RayExecutor(Executor):
    """A `concurrent.futures.Executor` whose tasks are tasks of Ray.

    Args:
        address: ``auto`` for the cluster of this machine, ``ray://host:10001`` for another one, ``local`` for processes
            of this machine.
        workers: number of processors of ``local``.

    Raises:
        ImportError: Ray is not installed.
        ConnectionError: there is no cluster.
    """

    def __init__(self, address: str = "auto", workers: int | None = None) -> None:
        try:
            import ray
        except ImportError:
            raise ImportError("Ray is not installed: pip install 'morse-simulator[ray]'") from None
        self._ray, self._starts = ray, not ray.is_initialized()
        if self._starts:
            options: Options = {"log_to_driver": False, "logging_level": "ERROR"}
            if address == "local":
                options |= {"num_cpus": workers, "include_dashboard": False}
            ray.init(address=address, **options)
        #: number of processors of the cluster
        resources: Any = ray.cluster_resources
        self.workers = max(1, int(resources().get("CPU", 1)))
        self._functions: dict[Any, Any] = {}

    def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[Any]:
        """Run a function on the cluster."""
        if fn not in self._functions:
            environment = {"env_vars": ONE_THREAD}
            self._functions[fn] = self._ray.remote(fn).options(max_retries=_RETRIES, runtime_env=environment)
        future: Future[Any] = self._functions[fn].remote(*args, **kwargs).future()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Disconnect, if this object has connected."""
        if self._starts:
            self._ray.shutdown()
