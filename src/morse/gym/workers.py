"""A vector of environments in several processes, each of which has a part of the rows."""

from __future__ import annotations

import contextlib
import itertools
import multiprocessing
import os
import pickle
import signal
import weakref
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from morse.core.reports.faults import describe
from morse.gym.checks import actions_of
from morse.gym.env import check_render_mode
from morse.gym.values import Observation
from morse.gym.vector import METADATA, Rows, mode_of
from morse.many.pool import ONE_THREAD, can_fork
from morse.many.rows import only_row_of, seeds_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

    from morse.core.values import Options
    from morse.gym.task import Task
    from morse.gym.values import Infos, Outcome
    from morse.viewer.notebook import Frame


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


def _kind_of_start() -> str:
    """How processes are started: as copies where that is possible, so that a program needs no ``__main__`` guard."""
    return "fork" if can_fork() else "spawn"


def _work(
    connection: Connection,
    task: Task | Callable[[], Task],
    place: slice,
    mode: AutoresetMode,
    inherited: Sequence[Connection],
) -> None:
    """Serve one part of the rows until the connection is closed.

    Args:
        inherited: ends of connections that only the other process is to have, so that its end is noticed.
    """
    for one in inherited:
        one.close()
    os.environ.update(ONE_THREAD)
    rows: Rows | None = None
    shared: _Shared | None = None
    first, count = place.start, place.stop - place.start
    with contextlib.suppress(EOFError, ConnectionError, KeyboardInterrupt):
        while True:
            order, content = connection.recv()
            try:
                answer: Any = None
                if order == "open":
                    rows = Rows(task, count, first, mode)
                    answer = rows.episodes.observation_space, rows.episodes.action_space
                elif order == "share":
                    shared = _Shared(*content)
                elif rows is not None and shared is not None:
                    if order == "reset":
                        observations, answer = rows.reset(*content)
                    elif order == "step":
                        observations, reward, ended, late, answer = rows.step(shared.action[place])
                        shared.reward[place], shared.ended[place], shared.late[place] = reward, ended, late
                    elif order == "show":
                        row, height, port = content
                        if first <= row < first + count:
                            answer = rows.episodes.many.show(row - first, height=height, port=port)
                    else:
                        answer = [rows.episodes.picture(row) for row in range(count)]
                    if order in ("reset", "step"):
                        shared.put(place, observations)
                connection.send((True, answer))
            except Exception as error:
                connection.send(
                    (False, f"in the process of the rows {first} to {first + count - 1}: {describe(error)}")
                )
    if shared is not None:
        shared.close(unlink=False)
    if rows is not None:
        rows.episodes.close()


class WorkersVectorEnv(VectorEnv[Observation, np.ndarray, np.ndarray]):
    """N simulations of a task in several processes; see `morse.gym.vector`."""

    metadata: ClassVar[Infos] = METADATA

    def __init__(
        self,
        task: Task | Callable[[], Task],
        num_envs: int,
        workers: int,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
    ) -> None:
        check_render_mode(render_mode)
        if not 1 <= workers <= num_envs:
            raise ValueError(f"{num_envs} rows need 1 to {num_envs} workers, not {workers}")
        self.render_mode, self.num_envs = render_mode, num_envs
        self.metadata = METADATA | {"autoreset_mode": mode_of(autoreset_mode)}  # type: ignore[misc]
        self._task = task
        self._memory: list[_Shared] = []
        self._connections: list[Connection] = []
        self._processes: list[BaseProcess] = []
        # also at the end of a program that does not close it
        self._end = weakref.finalize(self, _end, self._connections, self._processes, self._memory)
        edges = [num_envs * worker // workers for worker in range(workers + 1)]
        self._places = [slice(a, b) for a, b in itertools.pairwise(edges)]
        # before the processes start, which else have trackers of their own that remove the memory when they end
        resource_tracker.ensure_running()
        try:
            for number in range(workers):
                self._start(number)
            self.single_observation_space, self.single_action_space = self._ask("open", [None] * workers)[0]
            self._memory.append(_Shared(self.single_observation_space, self.single_action_space, num_envs))
            self._ask("share", [self._about()] * workers)
        except BaseException:
            self.close_extras()
            raise
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _start(self, number: int) -> None:
        """Start a process, in the place of an earlier one that has ended."""
        place, kind = self._places[number], _kind_of_start()
        context: Any = multiprocessing.get_context(kind)
        ours, theirs = context.Pipe()
        self._connections[number : number + 1] = [ours]
        process = context.Process(
            target=_work,
            args=(
                theirs,
                self._task,
                place,
                self.metadata["autoreset_mode"],
                list(self._connections) if kind == "fork" else [],
            ),
            daemon=True,
        )
        try:
            process.start()
        except (AttributeError, TypeError, pickle.PicklingError) as error:
            raise TypeError(
                f"the task cannot be sent to another process: {error}; on this system, a task for several processes is "
                "a class at the top of a file"
            ) from None
        theirs.close()
        self._processes[number : number + 1] = [process]

    def _replace(self) -> list[int]:
        """Start processes for those that have ended, and return their numbers."""
        numbers = [number for number, process in enumerate(self._processes) if not process.is_alive()]
        for number in numbers:
            self._connections[number].close()
            self._start(number)
            self._ask("open", [None], [number])
            self._ask("share", [self._about()], [number])
        return numbers

    def _about(self) -> tuple[Any, ...]:
        return self.single_observation_space, self.single_action_space, self.num_envs, self._shared.memory.name

    @property
    def _shared(self) -> _Shared:
        if not self._memory:
            raise ClosedEnvironmentError("this environment is closed: make it again")
        return self._memory[0]

    def _ask(self, order: str, contents: Sequence[Any], numbers: Sequence[int] | None = None) -> list[Any]:
        """Give processes an order, and return their answers.

        Args:
            numbers: of the processes; None for all.

        Raises:
            RuntimeError: a process has failed or has ended; the message says where.
        """
        answers: list[object] = []
        problems: list[str] = []
        asked = range(len(self._processes)) if numbers is None else numbers
        for number, content in zip(asked, contents, strict=True):
            with contextlib.suppress(ConnectionError):
                self._connections[number].send((order, content))
        for number in asked:
            place = self._places[number]
            try:
                good, answer = self._connections[number].recv()
            except (EOFError, ConnectionError):
                mend = _MAIN if order == "open" else "reset() starts another one"
                cause = _cause(self._processes[number])
                good = False
                answer = f"the process of the rows {place.start} to {place.stop - 1} has ended{cause}; {mend}"
            (answers if good else problems).append(answer)
        if problems:
            raise RuntimeError("\n".join(problems))
        return answers

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: Options | None = None
    ) -> tuple[Observation, Infos]:
        """Begin an episode in each row; see `morse.gym.TaskVectorEnv.reset`. Processes that have ended are replaced."""
        shared, others = self._shared, self._replace()
        seeds = None if seed is None else seeds_of(seed, range(self.num_envs))
        mask = (options or {}).get("reset_mask")
        contents = [
            (
                None if seeds is None else seeds[place],
                None if mask is None or number in others else np.asarray(mask)[place],
            )
            for number, place in enumerate(self._places)
        ]
        infos = self._ask("reset", contents)
        return shared.observations(), self._together(infos)

    def step(self, actions: object) -> Outcome:
        """Do an action in each row; see `morse.gym.TaskVectorEnv.step`."""
        shared = self._shared
        shared.action[:] = actions_of(actions, shared.action.shape)
        infos = self._together(self._ask("step", [None] * len(self._places)))
        return shared.observations(), shared.reward.copy(), shared.ended.copy(), shared.late.copy(), infos

    def _together(self, parts: Sequence[Infos]) -> Infos:
        """The infos of all rows."""
        infos: Infos = {}
        for place, part in zip(self._places, parts, strict=True):
            for name, value in part.items():
                if isinstance(value, dict):
                    parts_of_it = [one.get(name, {}) for one in parts]
                    infos[name] = self._together(parts_of_it)
                    continue
                if name not in infos:
                    empty: Any = None if value.dtype == object else 0
                    infos[name] = np.full((self.num_envs, *value.shape[1:]), empty, value.dtype)
                infos[name][place] = value
        return infos

    def render(self) -> np.ndarray | tuple[np.ndarray, ...] | None:
        """Return a picture (H, W, 3) of each row, if ``render_mode`` is ``rgb_array``."""
        if self.render_mode is None:
            return None
        return tuple(picture for part in self._ask("render", [None] * len(self._places)) for picture in part)

    def show(self, row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page that shows a row while it runs; see `morse.many.batch.Batch.show`."""
        row = only_row_of(row, self.num_envs)
        frame: Frame
        (frame,) = filter(None, self._ask("show", [(row, height, port)] * len(self._places)))
        return frame

    def close_extras(self, **kwargs: object) -> None:
        """End the processes."""
        self._end()


def _end(connections: list[Connection], processes: list[BaseProcess], memory: list[_Shared]) -> None:
    """End the processes of a vector, and release the memory that they share."""
    for connection in connections:
        connection.close()
    for process in processes:
        process.join(10.0)
        if process.is_alive():
            process.kill()
            process.join()
    while memory:
        memory.pop().close(unlink=True)


def _cause(process: BaseProcess) -> str:
    """What has ended a process, as the continuation of a sentence."""
    process.join(1.0)
    code = process.exitcode
    if code is None or code >= 0:
        return ""
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    return f" by {name}, perhaps because there was no memory left" if name == "SIGKILL" else f" by {name}"
