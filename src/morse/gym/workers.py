"""The rows of a vector of environments in several processes, each of which has a part of them."""

from __future__ import annotations

import itertools
import pickle
import weakref
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError

from morse.core.reports.faults import describe
from morse.gym.task import actions_of
from morse.gym.values import Observation, joined
from morse.gym.vector import Rows, check_over
from morse.system.workers import Server, Worker, WorkerError, WorkerPool, close_all

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from gymnasium.vector import AutoresetMode
    from numpy.typing import NDArray

    from morse.gym.task import Task
    from morse.gym.values import Infos, Outcome
    from morse.viewer.notebook import Frame


T = TypeVar("T")
#: wall-clock time for a step that is under way when a vector is closed, s
_PATIENCE = 0.1
#: why a process may end at once, where processes cannot be copied
_MAIN = "a program that starts processes does so below `if __name__ == '__main__':` (needed on Windows and macOS)"


class _Shared:
    """The arrays of all rows in memory that the processes share.

    Attributes:
        parts: observations by name; the name is empty if they are no dictionary.
    """

    def __init__(
        self,
        observation: spaces.Space[Observation],
        action: spaces.Space[Observation],
        rows: int,
        name: str | None = None,
    ) -> None:
        named = observation.spaces if isinstance(observation, spaces.Dict) else {"": observation}
        fields = {f"observation {key}": (space.shape, space.dtype) for key, space in named.items()}
        fields |= {"action": (action.shape, action.dtype), "reward": ((), np.float64)}
        fields |= {"ended": ((), np.bool_), "late": ((), np.bool_)}
        sizes = {
            key: rows * int(np.prod(shape, dtype=int)) * np.dtype(dtype).itemsize
            for key, (shape, dtype) in fields.items()
        }
        places, total = {}, 0
        for key, size in sizes.items():
            places[key] = total
            total += -(-size // 64) * 64
        self.memory = SharedMemory(name, create=name is None, size=max(total, 1))
        self._arrays = {
            key: np.ndarray((rows, *shape), dtype, self.memory.buf, places[key])
            for key, (shape, dtype) in fields.items()
        }
        self.parts = {key: self._arrays[f"observation {key}"] for key in named}
        self.action, self.reward = self._arrays["action"], self._arrays["reward"]
        self.ended, self.late = self._arrays["ended"], self._arrays["late"]

    def put(self, rows: slice, observations: Observation) -> None:
        """Set observations of some rows."""
        for name, array in self.parts.items():
            array[rows] = observations[name] if name else observations

    def observations(self) -> Observation:
        """Return a copy of the observations of all rows."""
        copies = {name: array.copy() for name, array in self.parts.items()}
        return copies.get("", copies)

    def close(self, *, unlink: bool) -> None:
        """Release the memory."""
        self.parts.clear()
        self._arrays.clear()
        del self.action, self.reward, self.ended, self.late
        self.memory.close()
        if unlink:
            self.memory.unlink()


class _Part(Server):
    """The rows of one process, which answers questions about them."""

    def __init__(self, task: Task | Callable[[], Task], place: slice, mode: AutoresetMode) -> None:
        self._task, self._place, self._mode = task, place, mode
        self._rows: Rows
        self._shared: _Shared | None = None

    def answer(self, question: bytes) -> bytes:
        """Do an order with its arguments; return whether that was possible, and the result or the text of an error."""
        order, arguments = pickle.loads(question)
        try:
            return pickle.dumps((True, getattr(self, order)(*arguments)))
        except Exception as error:
            first, last = self._place.start, self._place.stop - 1
            return pickle.dumps((False, f"in the process of the rows {first} to {last}: {describe(error)}"))

    def load(self) -> tuple[Any, ...]:
        """Load the simulations; return the spaces of a row."""
        self._rows = Rows(self._task, self._place.stop - self._place.start, self._place.start, self._mode)
        return self._rows.spaces

    def share(self, rows: int, memory: str) -> None:
        """Use the memory that all processes share.

        Args:
            rows: number of all rows.
        """
        self._shared = _Shared(*self._rows.spaces, rows, memory)

    def reset(self, seeds: Sequence[int] | None, mask: NDArray[np.bool_]) -> Infos:
        """See `Rows.reset`."""
        observations, infos = self._rows.reset(seeds, mask)
        self._memory.put(self._place, observations)
        return infos

    def step(self) -> Infos:
        """See `Rows.step`."""
        shared, place = self._memory, self._place
        observations, shared.reward[place], shared.ended[place], shared.late[place], infos = self._rows.step(
            shared.action[place]
        )
        shared.put(place, observations)
        return infos

    def pictures(self) -> tuple[np.ndarray, ...]:
        """Return a picture of each row."""
        return self._rows.pictures()

    def show(self, row: int, height: int, port: int) -> Frame:
        """Show a row of all rows."""
        return self._rows.show(row - self._place.start, height, port)

    @property
    def _memory(self) -> _Shared:
        assert self._shared is not None
        return self._shared

    def close(self) -> None:
        """End the simulations."""
        if self._shared is not None:
            self._shared.close(unlink=False)
            self._rows.close()


class _Parts:
    """The processes of all rows, and the memory that they share; for one thread.

    Args:
        places: rows of each process.
    """

    def __init__(self, task: Task | Callable[[], Task], places: Sequence[slice], mode: AutoresetMode) -> None:
        self._task, self._places, self._mode, self._count = task, places, mode, places[-1].stop
        self.workers: dict[int, Worker] = {}
        self._spaces: tuple[Any, Any] = None, None
        self._shared: _Shared | None = None
        self._over = np.zeros(self._count, bool)
        # rows whose process has ended go on with new seeds: those of the start would do the same again
        self._seeds = np.random.default_rng([len(places), self._count])

    def load(self) -> tuple[Any, ...]:
        """Start the processes that are not there; return the spaces of a row, and the numbers of these processes."""
        # before the processes start, which else have trackers of their own that remove the memory when they end
        resource_tracker.ensure_running()
        gone = [number for number, worker in self.workers.items() if not worker.is_alive]
        close_all(self.workers.pop(number) for number in gone)
        new = [number for number in range(len(self._places)) if number not in self.workers]
        try:
            for number in new:
                self.workers[number] = self._start(self._places[number])
            if new:
                self._spaces = self._ask("load", dict.fromkeys(new, ()))[0]
                self._shared = self._shared or _Shared(*self._spaces, self._count)
                self._ask("share", dict.fromkeys(new, (self._count, self._shared.memory.name)))
        except BaseException:
            close_all(self.workers.pop(number) for number in new if number in self.workers)
            raise
        return *self._spaces, new

    def _start(self, place: slice) -> Worker:
        try:
            return Worker.copy(_Part, self._task, place, self._mode)
        except (AttributeError, TypeError, pickle.PicklingError) as error:
            raise TypeError(
                f"the task cannot be sent to another process: {error}; on this system, a task for several processes is "
                "a class at the top of a file"
            ) from None

    def _ask(self, order: str, arguments: Mapping[int, tuple[object, ...]]) -> list[Any]:
        """Give processes an order, and return their answers.

        Args:
            arguments: of the order, by number of the process.

        Raises:
            RuntimeError: a process has failed or has ended; the message says where.
        """
        answers: list[object] = []
        problems: list[str] = []
        for number, values in arguments.items():
            self.workers[number].send(pickle.dumps((order, values)))
        for number in arguments:
            try:
                good, answer = pickle.loads(self.workers[number].receive())
            except WorkerError as cause:
                first, last = self._places[number].start, self._places[number].stop - 1
                mend = _MAIN if order == "load" else "reset() starts another one"
                good, answer = False, f"the process of the rows {first} to {last} has ended{cause}; {mend}"
            (answers if good else problems).append(answer)
        if problems:
            raise RuntimeError("\n".join(problems))
        return answers

    def _ask_all(self, order: str) -> list[Any]:
        return self._ask(order, dict.fromkeys(range(len(self._places)), ()))

    def _infos(self, parts: Sequence[Infos]) -> Infos:
        return joined(list(zip(self._places, parts, strict=True)), self._count)

    @property
    def _memory(self) -> _Shared:
        assert self._shared is not None
        return self._shared

    def reset(self, seeds: Sequence[int] | None, mask: NDArray[np.bool_]) -> tuple[Observation, Infos]:
        """Begin episodes in the rows of a mask, and in those of processes that had ended."""
        *_, new = self.load()
        arguments: dict[int, tuple[object, ...]] = {}
        for number, place in enumerate(self._places):
            own = None if seeds is None else seeds[place]
            if number in new:
                mask[place] = True
                own = own or self._seeds.integers(2**31, size=place.stop - place.start).tolist()
            arguments[number] = own, mask[place]
        infos = self._infos(self._ask("reset", arguments))
        self._over[mask] = False
        return self._memory.observations(), infos

    def step(self, actions: np.ndarray) -> Outcome:
        """Do an action in each row."""
        check_over(self._over, self._mode)
        shared = self._memory
        shared.action[:] = actions
        infos = self._infos(self._ask_all("step"))
        ended, late = shared.ended.copy(), shared.late.copy()
        self._over = ended | late
        return shared.observations(), shared.reward.copy(), ended, late, infos

    def pictures(self) -> tuple[np.ndarray, ...]:
        """Return a picture of each row."""
        return tuple(itertools.chain(*self._ask_all("pictures")))

    def show(self, row: int, height: int, port: int) -> Frame:
        """Show a row."""
        number = next(number for number, place in enumerate(self._places) if row < place.stop)
        frame: Frame
        (frame,) = self._ask("show", {number: (row, height, port)})
        return frame

    def close(self) -> None:
        """End the processes, and release the memory."""
        close_all(self.workers.values())
        if self._shared is not None:
            self._shared.close(unlink=True)

    def kill(self) -> None:
        """End the processes at once."""
        for worker in list(self.workers.values()):
            worker.kill()


class WorkerRows:
    """Rows in several processes; see `morse.gym.vector.VectorRows`."""

    def __init__(self, task: Task | Callable[[], Task], count: int, workers: int, mode: AutoresetMode) -> None:
        if not 1 <= workers <= count:
            raise ValueError(f"{count} rows need 1 to {count} workers, not {workers}")
        edges = [count * worker // workers for worker in range(workers + 1)]
        self.parts = parts = _Parts(task, list(itertools.starmap(slice, itertools.pairwise(edges))), mode)
        self._pool = WorkerPool(1, lambda: parts)
        # also at the end of a program that does not close it
        self.close = weakref.finalize(self, self._pool.close, _PATIENCE)
        try:
            observation, action, _ = self._pool.call(_Parts.load)
        except BaseException:
            self.close()
            raise
        self.spaces = observation, action
        self._shape = count, *action.shape

    def _call(self, job: Callable[[_Parts], T]) -> T:
        if not self.close.alive:
            raise ClosedEnvironmentError("this environment is closed: make it again")
        return self._pool.call(job)

    def reset(self, seeds: Sequence[int] | None, mask: NDArray[np.bool_]) -> tuple[Observation, Infos]:
        """See `morse.gym.vector.VectorRows`; processes that have ended are replaced."""
        return self._call(lambda parts: parts.reset(seeds, mask))

    def step(self, actions: np.ndarray) -> Outcome:
        """See `morse.gym.vector.VectorRows`."""
        array = actions_of(actions, self._shape)
        return self._call(lambda parts: parts.step(array))

    def pictures(self) -> tuple[np.ndarray, ...]:
        """See `morse.gym.vector.VectorRows`."""
        return self._call(_Parts.pictures)

    def show(self, row: int, height: int, port: int) -> Frame:
        """See `morse.gym.vector.VectorRows`."""
        return self._call(lambda parts: parts.show(row, height, port))
