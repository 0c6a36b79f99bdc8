"""The robots of one world as rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.declarations import fields_of_component
from morse.gym.variety import AGENT
from morse.launch.load import load
from morse.many.commands import CommandColumn
from morse.many.layout import Layout
from morse.many.readings import ContactColumn, DataColumn
from morse.many.scenes import Scenes
from morse.many.window import Window
from morse.simulation.handles.component_handles import handle_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np

    from morse.core.declarations import DataField
    from morse.simulation.handles.component_handles import ComponentHandle
    from morse.simulation.simulation import Simulation
    from morse.viewer.notebook import Frame


class Team:
    """One simulation whose rows are its robots; it has the methods of `morse.many.batch.Batch` that a task needs.

    ``{agent}`` in a name stands for the robot of the row.

    Raises:
        KeyError: the scene has no such robot.
    """

    def __init__(self, scene: Any, agents: Sequence[str], seed: int = 0) -> None:
        self.agents = list(agents)
        self._scene = scene[0] if isinstance(scene, list) else scene
        self._simulation = load(self._scene, seed=seed)
        self._window: Window | None = None
        self._commands: list[CommandColumn] = []
        self._readings: list[DataColumn | ContactColumn] = []
        try:
            self._handles(AGENT)
        except BaseException:
            self.close()
            raise

    def __len__(self) -> int:
        return len(self.agents)

    def __getitem__(self, row: int) -> object:
        return self._simulation

    def declarations(self, name: str) -> Mapping[str, DataField]:
        """Return the declared data of the component of the first robot."""
        return fields_of_component(self._handles(name)[0].component)

    def _handles(self, name: str, simulation: Simulation | None = None) -> list[ComponentHandle]:
        one = simulation or self._simulation
        return [handle_of(one, self._full(name, agent)) for agent in self.agents]

    @staticmethod
    def _full(name: str, agent: str) -> str:
        return name.replace(AGENT, agent) if isinstance(name, str) else name

    def command(self, component: str, *fields: str) -> np.ndarray:
        """See `morse.many.batch.Batch.command`."""
        handles = self._handles(component)
        column = CommandColumn(Layout(component, fields, handles[0].component.local_data), handles)
        self._commands.append(column)
        return column.array

    def read(self, component: str, *fields: str) -> np.ndarray:
        """See `morse.many.batch.Batch.read`."""
        with load(self._scene, seed=self._simulation.seed()) as probe:
            probe.step(1, measure=True)
            layout = Layout(component, fields, self._handles(component, probe)[0].component.local_data)
        self._readings.append(DataColumn(layout, self._handles(component)))
        return self._readings[-1].array

    def contacts(self, robot: str) -> np.ndarray:
        """See `morse.many.batch.Batch.contacts`."""
        self._readings.append(ContactColumn([handle.contacts() for handle in self._handles(robot)]))
        return self._readings[-1].array

    def show(self, _row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """See `morse.many.batch.Batch.show`; all rows are in one world."""
        if self._window is None:
            self._window = Window(Scenes(self._scene, 1, (), {}), port)
        return self._window.show(0, height)

    def step(self, ticks: int, *, measure: bool) -> None:
        """See `morse.many.batch.Batch.step`."""
        for column, (rows, _) in [(column, column.check()) for column in self._commands]:
            column.publish(rows)
        self._simulation.step(ticks, measure=measure)
        self._update()

    def measure(self, rows: Sequence[int]) -> None:
        """Let all sensors measure now."""
        self._simulation.measure()
        self._update()

    def restart(self, rows: Sequence[int], seeds: Sequence[int]) -> None:
        """Restart the world, with the seed of its first row."""
        self._simulation.restart(seeds[0])
        for column in self._commands:
            column.forget(range(len(self)))
        for reading in self._readings:
            reading.begin(range(len(self)))

    def place(self, rows: Sequence[int], name: str, poses: Sequence[Sequence[float]]) -> None:
        """See `morse.many.batch.Batch.place`."""
        for row, pose in zip(rows, poses, strict=True):
            self._simulation.place(self._full(name, self.agents[row]), pose)

    def vary(self, name: str, *, rows: Sequence[int], **values: object) -> None:
        """See `morse.many.batch.Batch.vary`."""
        for row in rows:
            for what, value in values.items():
                getattr(self._simulation, f"set_{what}")(self._full(name, self.agents[row]), value)

    def _update(self) -> None:
        for reading in self._readings:
            reading.update(range(len(self)))
        if self._window is not None:
            self._window.turn(lambda _row: self._simulation)

    def close(self) -> None:
        """End the simulation."""
        if self._window is not None:
            self._window.close()
        self._simulation.close()
