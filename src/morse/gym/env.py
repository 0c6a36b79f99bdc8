"""A task as an environment of Gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import gymnasium
import numpy as np

from morse.gym.episodes import Episodes, scenes_of
from morse.gym.task import actions_of
from morse.gym.values import Observation, row_of
from morse.many.batch import batch

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.gym.task import Task
    from morse.gym.values import Infos
    from morse.viewer.notebook import Frame

#: rate of pictures for films, Hz
_RATE = 10


class TaskEnv(gymnasium.Env[Observation, np.ndarray]):
    """One simulation of a task; ``gymnasium.make`` creates it.

    Args:
        task: a task, or its class.
        render_mode: ``rgb_array`` for `render`.
    """

    metadata: ClassVar[dict[str, object]] = {"render_modes": ["rgb_array"], "render_fps": _RATE}

    def __init__(self, task: Task | Callable[[], Task], render_mode: str | None = None) -> None:
        check_render_mode(render_mode)
        self.render_mode = render_mode
        self._episodes = Episodes(task, lambda one: batch(scenes_of(one, 0, 1), 1, on_failure="raise"))
        self.observation_space, self.action_space = self._episodes.observation_space, self._episodes.action_space

    @property
    def task(self) -> Task:
        """The task."""
        return self._episodes.task

    def reset(self, *, seed: int | None = None, options: dict[str, object] | None = None) -> tuple[Observation, Infos]:
        """Begin an episode."""
        super().reset(seed=seed)
        if seed is None:
            self._episodes.generators[0] = self.np_random
        self._episodes.begin([0], None if seed is None else [seed])
        self._np_random = self._episodes.generators[0]
        return row_of(self._episodes.observations(), 0), dict(self._episodes.drawn[0])

    def step(self, action: object) -> tuple[Observation, float, bool, bool, Infos]:
        """Do an action."""
        rewards, ended, late, infos = self._episodes.step(actions_of(action, self.action_space.shape or ())[None])
        seen, info = row_of(self._episodes.observations(), 0), row_of(infos, 0)
        return seen, float(rewards[0]), bool(ended[0]), bool(late[0]), info

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture (H, W, 3), if ``render_mode`` is ``rgb_array``."""
        return None if self.render_mode is None else self._episodes.picture()

    def show(self, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page that shows the simulation while it runs; see `morse.many.batch.Batch.show`."""
        frame: Frame = self._episodes.many.show(0, height=height, port=port)
        return frame

    def close(self) -> None:
        """End the simulation."""
        self._episodes.close()


def check_render_mode(mode: str | None) -> None:
    """Raise ValueError for an unknown mode."""
    if mode not in (None, "rgb_array"):
        raise ValueError(f"render_mode is 'rgb_array' or None, not {mode!r}")
