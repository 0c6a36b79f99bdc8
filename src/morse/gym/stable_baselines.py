"""A task as a vector for the learners of Stable-Baselines3."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.gym.values import row_infos
from morse.gym.vector import vector

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError:
    raise ImportError("morse.gym.baselines needs Stable-Baselines3: pip install stable-baselines3") from None

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.gym.task import Task
    from morse.gym.values import Infos, Observation
    from morse.viewer.notebook import Frame


class BaselinesVecEnv(VecEnv):
    """N simulations of a task, see `baselines`."""

    def __init__(
        self, task: Task | Callable[[], Task], num_envs: int, workers: int = 0, render_mode: str | None = None
    ) -> None:
        self.envs = vector(task, num_envs, workers=workers, render_mode=render_mode)
        self._actions = np.zeros(0)
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    def reset(self) -> Observation:
        """Begin an episode in each row, with the seeds of ``seed(s)`` if it was called; return the observations."""
        seeds = None if any(seed is None for seed in self._seeds) else [int(seed) for seed in self._seeds]
        observations, infos = self.envs.reset(seed=seeds)
        self.reset_infos = [row_infos(infos, row) for row in range(self.num_envs)]
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Take the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Observation, np.ndarray, np.ndarray, list[Infos]]:
        """Do the actions: observations, rewards, whether episodes have ended, and an info for each row."""
        observations, rewards, ended, late, infos = self.envs.step(self._actions)
        done = ended | late
        rows = []
        for row in range(self.num_envs):
            info = row_infos(infos["final_info"] if done[row] else infos, row)
            info["TimeLimit.truncated"] = bool(late[row] and not ended[row])
            if done[row]:
                info["terminal_observation"] = infos["final_obs"][row]
                self.reset_infos[row] = row_infos(infos, row)
            rows.append(info)
        return observations, np.asarray(rewards, np.float32), done, rows

    def show(self, row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page that shows a row while it runs; see `morse.many.batch.Batch.show`."""
        frame: Frame = self.envs.show(row, height=height, port=port)
        return frame

    def close(self) -> None:
        """End the simulations."""
        self.envs.close()

    def get_images(self) -> Sequence[Any]:
        """Return a picture (H, W, 3) of each row."""
        pictures: Sequence[object] = self.envs.render() or [None] * self.num_envs
        return pictures

    def get_attr(self, attr_name: str, indices: object = None) -> list[object]:
        """Return an attribute of the vector, once for each row."""
        return [getattr(self.envs, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: object, indices: object = None) -> None:
        """Set an attribute of the vector, for all rows."""
        setattr(self.envs, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: object, indices: object = None, **method_kwargs: object
    ) -> list[object]:
        """Rows are no objects, and have no methods.

        Raises:
            AttributeError: always.
        """
        raise AttributeError(f"rows of a vector have no method '{method_name}': call it on the task")

    def env_is_wrapped(self, wrapper_class: type, indices: object = None) -> list[bool]:
        """Return that no row is wrapped."""
        return [False for _ in self._get_indices(indices)]


def baselines(
    task: Task | Callable[[], Task], num_envs: int, *, workers: int = 0, render_mode: str | None = None
) -> BaselinesVecEnv:
    """Return a vector of environments for Stable-Baselines3, a ``VecEnv``; see `morse.gym.vector`."""
    return BaselinesVecEnv(task, num_envs, workers, render_mode)
