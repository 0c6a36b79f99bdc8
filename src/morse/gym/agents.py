"""A task for the robots of one world, as a parallel environment of PettingZoo."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

try:
    from pettingzoo import ParallelEnv
except ImportError:
    from morse.system.extras import install

    raise ImportError(f"morse.gym.parallel needs PettingZoo: {install('gym')}") from None

import numpy as np

from morse.gym.env import check_render_mode
from morse.gym.episodes import Episodes, scenes_of
from morse.gym.task import actions_of
from morse.gym.values import Observation, row_of
from morse.many.rows import RowArrays, rows_of
from morse.many.scenes import Scenes
from morse.many.window import Window

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from morse.gym.task import Task
    from morse.gym.values import Infos
    from morse.simulation.simulation import Simulation
    from morse.viewer.notebook import Frame


#: what stands for the robot of a row in names
AGENT = "{agent}"


class Team(RowArrays):
    """One simulation whose rows are its robots; ``{agent}`` in a name stands for the robot of the row.

    Raises:
        KeyError: the scene has no such robot.
    """

    def __init__(self, scene: Any, agents: Sequence[str], seed: int = 0) -> None:
        super().__init__()
        self._agents = list(agents)
        self._scenes = Scenes(scene[0] if isinstance(scene, list) else scene, 1, (), {"on_failure": "raise"})
        self._simulation = self._scenes.load(0, seed, "")
        self._window: Window | None = None
        try:
            self._handles(AGENT)
        except BaseException:
            self.close()
            raise

    def __len__(self) -> int:
        return len(self._agents)

    def __getitem__(self, row: int) -> Simulation:
        return self._simulation

    def _rows(self, rows: object) -> list[int]:
        return rows_of(rows, len(self))

    def _simulation_of(self, row: int) -> Simulation:
        return self._simulation

    def _load_sample(self) -> Simulation:
        return self._scenes.load(0, self._simulation.seed())

    def name_in(self, row: int, name: str) -> str:
        """Return a name with the robot of the row."""
        return name.replace(AGENT, self._agents[row]) if isinstance(name, str) else name

    def step(self, ticks: int, *, measure: bool) -> None:
        """See `morse.many.batch.Batch.step`."""
        for column, rows in [(column, column.check()) for column in self._commands]:
            column.publish(rows)
        self._simulation.step(ticks, measure=measure)
        self._look()

    def measure(self, rows: Sequence[int]) -> None:
        """Let all sensors measure now."""
        self._simulation.measure()
        self._look()

    def restart(self, rows: Sequence[int], seeds: Sequence[int]) -> None:
        """Restart the world, with the seed of its first row."""
        self._simulation.restart(seeds[0])
        self._begin(range(len(self)))

    def _look(self) -> None:
        self._update(range(len(self)))
        if self._window is not None:
            self._window.turn(self._simulation_of)

    def show(self, row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """See `morse.many.batch.Batch.show`; all rows are in one world."""
        if self._window is None:
            self._window = Window(self._scenes, port)
        return self._window.show(0, height)

    def close(self) -> None:
        """End the simulation."""
        if self._window is not None:
            self._window.close()
        self._simulation.close()


class TeamEnv(ParallelEnv[str, Observation, np.ndarray]):
    """Robots of one world as agents; the rows of the task are the agents.

    An agent whose episode has ended gets the action nearest to 0, until all have ended.
    """

    metadata: ClassVar[dict[str, object]] = {"name": "morse_v0", "render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(self, task: Task | Callable[[], Task], agents: Sequence[str], render_mode: str | None = None) -> None:
        check_render_mode(render_mode)
        self.render_mode = render_mode
        self.possible_agents: list[str] = list(agents)
        self.agents: list[str] = []
        self._episodes = Episodes(task, lambda one: Team(scenes_of(one, 0, 1), agents))
        self._seeds = np.random.default_rng(0)
        self.observation_spaces = dict.fromkeys(self.possible_agents, self._episodes.observation_space)
        self.action_spaces = dict.fromkeys(self.possible_agents, self._episodes.action_space)

    def observation_space(self, agent: str) -> object:
        """Return the space of the observations of an agent."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> object:
        """Return the space of the actions of an agent."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, object] | None = None
    ) -> tuple[dict[str, Observation], dict[str, Infos]]:
        """Begin an episode of all agents."""
        if seed is not None:
            self._seeds = np.random.default_rng(seed)
        count = len(self.possible_agents)
        self._episodes.begin(list(range(count)), self._seeds.integers(2**31, size=count).tolist())
        self.agents = list(self.possible_agents)
        infos = {agent: dict(self._episodes.drawn[row]) for row, agent in enumerate(self.agents)}
        return self._observations(), infos

    def _observations(self) -> dict[str, object]:
        observations = self._episodes.observations()
        return {agent: row_of(observations, self.possible_agents.index(agent)) for agent in self.agents}

    def step(
        self, actions: Mapping[str, object]
    ) -> tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Infos]]:
        """Do an action of each agent."""
        space = self._episodes.action_space
        given = np.array([np.clip(np.zeros(space.shape), space.low, space.high)] * len(self.possible_agents))
        rows = {agent: self.possible_agents.index(agent) for agent in self.agents}
        for agent, row in rows.items():
            if agent not in actions:
                raise ValueError(f"the action of '{agent}' is missing; agents are {', '.join(self.agents)}")
            given[row] = actions_of(actions[agent], space.shape or ())
        rewards, ended, late, values = self._episodes.step(given)
        observations = self._observations()
        result = (
            observations,
            {agent: float(rewards[row]) for agent, row in rows.items()},
            {agent: bool(ended[row]) for agent, row in rows.items()},
            {agent: bool(late[row]) for agent, row in rows.items()},
            {agent: row_of(values, row) for agent, row in rows.items()},
        )
        self.agents = [agent for agent, row in rows.items() if not (ended[row] or late[row])]
        return result

    def render(self) -> np.ndarray | tuple[np.ndarray, ...] | None:
        """Return a picture (H, W, 3), if ``render_mode`` is ``rgb_array``."""
        return None if self.render_mode is None else self._episodes.picture()

    def show(self, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page that shows the world while it runs; see `morse.many.batch.Batch.show`."""
        frame: Frame = self._episodes.many.show(height=height, port=port)
        return frame

    def close(self) -> None:
        """End the simulation."""
        self._episodes.close()


def parallel(task: Task | Callable[[], Task], agents: Sequence[str], render_mode: str | None = None) -> TeamEnv:
    """Return a parallel environment of PettingZoo, whose agents are robots of one world.

    In the names of components of the task, ``{agent}`` stands for the robot: ``Read("{agent}.laser", "range_list")``.

    Args:
        agents: names of the robots.

    Raises:
        KeyError: the scene has no such robot.
    """
    return TeamEnv(task, agents, render_mode)
