"""The one way to a cluster of Ray: functions, and workers that keep something."""

from __future__ import annotations

import logging
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from morse.system.extras import install
from morse.system.workers import ONE_THREAD, WorkerError

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Future

    from morse.system.workers import Server

#: how often Ray tries a call whose node dies
_RETRIES = 2


class RayExecutor(Executor):
    """A connection to a cluster: a `concurrent.futures.Executor` whose tasks are tasks of Ray.

    Args:
        address: ``auto`` for the cluster of this machine, ``ray://host:10001`` for another one, ``local`` for processes
            of this machine.
        workers: number of processors of ``local``; None for all.

    Attributes:
        workers: number of processors of the cluster.

    Raises:
        ImportError: Ray is not installed.
        ConnectionError: there is no cluster.
    """

    def __init__(self, address: str = "auto", workers: int | None = None) -> None:
        try:
            import ray
        except ImportError:
            raise ImportError(f"Ray is not installed: {install('ray')}") from None
        self._ray, self._starts = ray, not ray.is_initialized()
        if self._starts:
            options: dict[str, Any] = {"log_to_driver": False, "logging_level": logging.ERROR}
            if address == "local":
                options |= {"num_cpus": workers, "include_dashboard": False}
            ray.init(address=address, **options)
        resources: Any = ray.cluster_resources
        self.workers = max(1, int(resources().get("CPU", 1)))
        self._functions: dict[Any, Any] = {}

    def _remote(self, of: Any, **options: object) -> Any:
        return self._ray.remote(of).options(runtime_env={"env_vars": ONE_THREAD}, **options)

    def submit(self, fn: Callable[..., object], /, *args: object, **kwargs: object) -> Future[Any]:
        """Run a function on the cluster."""
        if fn not in self._functions:
            self._functions[fn] = self._remote(fn, max_retries=_RETRIES)
        future: Future[object] = self._functions[fn].remote(*args, **kwargs).future()
        return future

    def worker(self, server: Callable[[], Server]) -> RayWorker:
        """Start a worker on any node, with a processor of its own."""
        return RayWorker(self._ray, self._remote(server, num_cpus=1).remote())

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Disconnect, if this object has connected."""
        if self._starts:
            self._starts = False
            self._ray.shutdown()


class RayWorker:
    """A worker on a cluster; see `morse.system.workers.Worker`.

    Args:
        ray: the module.
        actor: what Ray has started.
    """

    pid = 0

    def __init__(self, ray: Any, actor: Any) -> None:
        self._ray, self.actor = ray, actor

    def ask(self, question: bytes, patience: float | None = None) -> bytes:
        """Ask, and return the answer.

        Raises:
            WorkerError: the actor or its node has ended, or does not answer in time.
        """
        errors = self._ray.exceptions
        try:
            answer: bytes = self._ray.get(self.actor.answer.remote(question), timeout=patience)
        except (errors.RayActorError, errors.GetTimeoutError) as error:
            raise WorkerError(f": {error}") from None
        return answer

    def kill(self) -> None:
        """End the actor."""
        self._ray.kill(self.actor)

    close = kill
