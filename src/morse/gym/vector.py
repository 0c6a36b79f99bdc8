"""A task as a vector of environments, in one process or in several."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from morse.gym.env import check_render_mode
from morse.gym.episodes import Episodes, scenes_of
from morse.gym.values import Observation, masked, row_of, stacked
from morse.many.batch import batch
from morse.many.rows import only_row_of, seeds_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from gymnasium import Space
    from numpy.typing import NDArray

    from morse.gym.task import Task
    from morse.gym.values import Infos, Outcome
    from morse.viewer.notebook import Frame


#: what gymnasium wants to know of a vector
METADATA = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": ["rgb_array"], "render_fps": 10}


def mode_of(mode: AutoresetMode | str) -> AutoresetMode:
    """Return when episodes begin anew.

    Raises:
        ValueError: there is no such mode.
    """
    try:
        return AutoresetMode(mode)
    except ValueError:
        names = ", ".join(f"'{one.value}'" for one in AutoresetMode)
        raise ValueError(f"autoreset_mode is one of {names}, not {mode!r:.80}") from None


def mask_of(options: dict[str, object] | None, rows: int) -> NDArray[np.bool_]:
    """Return (N,) which rows begin an episode: those of the option ``reset_mask``, or all.

    Raises:
        ValueError: the mask is something else.
    """
    mask = (options or {}).get("reset_mask")
    if mask is None:
        return np.ones(rows, bool)
    array = np.asarray(mask)
    if array.dtype != bool or array.shape != (rows,):
        raise ValueError(f"reset_mask is an array of {rows} booleans, not {mask!r:.80}")
    return array.copy()


def check_over(over: NDArray[np.bool_], mode: AutoresetMode, first: int = 0) -> None:
    """Raise an error if rows whose episodes are over are to be stepped, and no step begins them anew.

    Args:
        over: (N,) which rows these are.
        first: number of the first row.

    Raises:
        ResetNeeded: the message names the rows.
    """
    if over.any() and mode is AutoresetMode.DISABLED:
        rows = (np.flatnonzero(over) + first).tolist()
        raise ResetNeeded(f'the episodes of the rows {rows} are over: call reset(options={{"reset_mask": …}})')


class Rows:
    """Rows of a task, whose episodes begin anew as the mode says.

    Args:
        first: number of the first row in the whole vector.
    """

    def __init__(self, task: Task | Callable[[], Task], count: int, first: int, mode: AutoresetMode) -> None:
        self._mode = mode
        self._over = np.zeros(count, bool)  # rows whose episode has ended and that have not begun another
        self.episodes = Episodes(
            task,
            lambda one: batch(scenes_of(one, first, count), count, seed=first, first_row=first, on_failure="raise"),
            first,
        )
        self.count = count
        self.spaces = self.episodes.observation_space, self.episodes.action_space

    def reset(self, seeds: Sequence[int] | None, mask: NDArray[np.bool_]) -> tuple[Observation, Infos]:
        """Begin episodes in the rows of a mask; in all rows if none has begun yet."""
        episodes = self.episodes
        rows = np.flatnonzero(mask).tolist() if episodes.has_begun else list(range(self.count))
        episodes.begin(rows, None if seeds is None else [seeds[row] for row in rows])
        self._over[rows] = False
        return episodes.observations(), self._drawn(rows)

    def _drawn(self, rows: Sequence[int]) -> Infos:
        return stacked({row: self.episodes.drawn[row] for row in rows}, self.count)

    def step(self, actions: np.ndarray) -> Outcome:
        """Do an action in all rows; see `TaskVectorEnv.step`."""
        episodes, over = self.episodes, self._over.copy()
        check_over(over, self._mode, episodes.task.first_row)
        rewards, ended, late, values = episodes.step(actions)
        infos = masked(values, ~over)
        if over.any():  # the step in which these begin another episode does nothing else
            rewards[over], ended[over], late[over] = 0.0, False, False
            rows = np.flatnonzero(over).tolist()
            episodes.begin(rows)
            infos |= self._drawn(rows)
        done = ended | late
        observations = episodes.observations()
        if self._mode is not AutoresetMode.SAME_STEP:
            self._over = done
        elif done.any():
            rows = np.flatnonzero(done).tolist()
            final = np.full(self.count, None, object)
            for row in rows:
                final[row] = row_of(observations, row)
            infos |= {"final_obs": final, "_final_obs": done.copy()}
            infos |= {"final_info": masked(values, done), "_final_info": done.copy()}
            episodes.begin(rows)
            observations = episodes.observations()
            infos |= self._drawn(rows)
        return observations, rewards, ended, late, infos

    def pictures(self) -> tuple[np.ndarray, ...]:
        """Return a picture (H, W, 3) of each row."""
        return tuple(self.episodes.picture(row) for row in range(self.count))

    def show(self, row: int, height: int, port: int) -> Frame:
        """Show a row; see `morse.many.batch.Batch.show`."""
        frame: Frame = self.episodes.many.show(row, height=height, port=port)
        return frame

    def close(self) -> None:
        """End the simulations."""
        self.episodes.close()


class VectorRows(Protocol):
    """What runs the rows of a `TaskVectorEnv`: `Rows` in this process, `morse.gym.workers.WorkerRows` in others.

    Attributes:
        spaces: of the observations and the actions of a row.
    """

    spaces: tuple[Space[Observation], Space[np.ndarray]]

    def reset(self, seeds: Sequence[int] | None, mask: NDArray[np.bool_]) -> tuple[Observation, Infos]:
        """Begin episodes in the rows of a mask, and in all that have none."""

    def step(self, actions: np.ndarray) -> Outcome:
        """Do an action in each row."""

    def pictures(self) -> tuple[np.ndarray, ...]:
        """Return a picture (H, W, 3) of each row."""

    def show(self, row: int, height: int, port: int) -> Frame:
        """Show a row; see `morse.many.batch.Batch.show`."""

    def close(self) -> None:
        """End the simulations."""


class TaskVectorEnv(VectorEnv[Observation, np.ndarray, np.ndarray]):
    """N simulations of a task; ``gymnasium.make_vec`` and `vector` create it.

    By default, an episode that ends begins anew in the same step (``AutoresetMode.SAME_STEP``): the observation is that
    of the new episode, ``infos["final_obs"][k]`` the last one of the old episode.

    With workers, a step or another call that an error interrupts (Ctrl+C, an error of a signal handler) is completed in
    all rows or has not begun in any: the vector can be used further.
    """

    metadata: ClassVar[dict[str, object]] = METADATA

    def __init__(
        self,
        task: Task | Callable[[], Task],
        num_envs: int = 1,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        workers: int = 0,
    ) -> None:
        check_render_mode(render_mode)
        mode = mode_of(autoreset_mode)
        self.render_mode, self.num_envs = render_mode, num_envs
        self.metadata = METADATA | {"autoreset_mode": mode}  # type: ignore[misc]
        self._rows: VectorRows
        if workers:
            from morse.gym.workers import WorkerRows

            self._rows = WorkerRows(task, num_envs, workers, mode)
        else:
            self._rows = Rows(task, num_envs, 0, mode)
        self.single_observation_space, self.single_action_space = self._rows.spaces
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, object] | None = None
    ) -> tuple[Observation, Infos]:
        """Begin an episode in each row; the seed of row ``k`` is ``seed + k``.

        Args:
            seed: a number, or a seed for each row; None to go on with the random numbers of each row, which at first
                depend on the number of the row alone.
            options: ``reset_mask``, (N,) booleans: only these rows. The first reset begins all rows. Processes that
                have ended are replaced, and their rows begin.

        Raises:
            ValueError: there is another number of seeds than rows, or ``reset_mask`` is not a mask.
        """
        seeds = None if seed is None else seeds_of(seed, range(self.num_envs))
        return self._rows.reset(seeds, mask_of(options, self.num_envs))

    def step(self, actions: np.ndarray) -> Outcome:
        """Do an action in each row: (N, ...) observations, (N,) rewards, terminated, truncated, and infos."""
        return self._rows.step(actions)

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return a picture (H, W, 3) of each row, if ``render_mode`` is ``rgb_array``."""
        return None if self.render_mode is None else self._rows.pictures()

    def show(self, row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page that shows a row while it runs; see `morse.many.batch.Batch.show`."""
        return self._rows.show(only_row_of(row, self.num_envs), height, port)

    def close_extras(self, **kwargs: object) -> None:
        """End the simulations."""
        self._rows.close()


def vector(
    task: Task | Callable[[], Task],
    num_envs: int,
    *,
    workers: int = 0,
    render_mode: str | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
) -> TaskVectorEnv:
    """Return a vector of environments.

    Row ``k`` gives the same bits with any number of workers.

    Args:
        task: a task, or its class; with workers a class at the top of a module.
        num_envs: number of simulations, N.
        workers: number of processes, each with a part of the rows; 0 for this process.
        render_mode: ``rgb_array`` for `render`, which returns a picture of each row.
        autoreset_mode: when an episode that has ended begins anew, as in Gymnasium: in the same step, in the next step
            (``NextStep``), or by `reset` with a ``reset_mask`` (``Disabled``).

    Raises:
        ValueError: there are more workers than rows, or no such mode.
    """
    return TaskVectorEnv(task, num_envs, render_mode, autoreset_mode, workers)
