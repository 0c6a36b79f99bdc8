"""The scenes of the rows of a batch."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import nearest
from morse.launch.load import described, load, resolve
from morse.scene import Scene
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.values import Options
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View


#: arguments of `morse.load` that hold for all rows
_OPTIONS = ("strict", "on_failure", "on_warning")
_ARGUMENTS = ("rows", "seed", "arguments", *_OPTIONS)


class Scenes:
    """Loads the simulation of any row.

    Args:
        scene: a scene as for `morse.load`; or a list of scenes, which the rows use in turn.
        arguments: ``sys.argv[1:]`` of the scene scripts; or a list of such lists, likewise.
        rows: number of rows; None for the number of scenes or lists of arguments.
        options: other arguments of `morse.load`.

    Raises:
        ValueError: no rows, or the number of rows is not known.
        TypeError: the number of rows is not an integer, or there is no such option.
    """

    def __init__(self, scene: Scene, rows: int | None, arguments: Sequence[object], options: Options) -> None:
        for name in options:
            if name not in _OPTIONS:
                text = f"morse.batch has no argument '{name}'{nearest(name, list(_ARGUMENTS))}"
                mend = (
                    "; many[k] is the simulation of row k, which can record" if name in ("record", "keep_last") else ""
                )
                raise TypeError(text + mend)
        self._scenes = list(scene) if isinstance(scene, (list, tuple)) else [scene]
        several = not isinstance(arguments, str) and any(isinstance(one, (list, tuple)) for one in arguments)
        self._arguments: list[Any] = list(arguments) if several else [arguments]
        self._options = options
        lengths = [len(self._scenes)] * isinstance(scene, (list, tuple)) + [len(self._arguments)] * several
        if rows is None:
            if not lengths:
                raise ValueError('batch needs the number of rows: morse.batch("arena.py", 64)')
            rows = max(lengths)
        elif isinstance(rows, bool) or not hasattr(rows, "__index__"):
            raise TypeError(f"the number of rows is an integer, not {rows!r:.80}")
        self.rows = int(rows)
        if self.rows < 1 or 0 in lengths:
            raise ValueError(
                f"a batch has at least one row and one scene, not {self.rows} rows of {lengths or [1]} scenes"
            )

    def load(self, row: int, seed: int | None) -> Simulation:
        """Load the simulation of a row; errors name the row."""
        scene, arguments = self._scenes[row % len(self._scenes)], self._arguments[row % len(self._arguments)]
        try:
            return load(scene, seed=seed, arguments=arguments, **self._options)
        except Exception as error:
            if self.rows > 1:
                error.add_note(f"while row {row} of the batch was loaded")
            raise

    def load_view(self, row: int, view: Callable[[Simulation], View], port: int) -> Simulation:
        """Load a simulation of the scene of a row for a page that shows the row.

        Args:
            view: creates the view.
            port: TCP port of the page; 0 for any free port.
        """
        from morse.simulation.simulation import Simulation

        scene, arguments = self._scenes[row % len(self._scenes)], self._arguments[row % len(self._arguments)]
        options = RunOptions(
            arguments=list(arguments), sockets=False, view="web", view_port=port, open_browser=False, speed=math.inf
        )
        description = described(scene, options)
        resolve(description)
        simulation = Simulation(description, options)
        try:
            simulation.load()
            simulation.view = view(simulation)
        except BaseException:
            simulation.close()
            raise
        simulation.observers.append(simulation.view)
        return simulation

    def are_alike(self, row: int, other: int) -> bool:
        """Whether two rows have the same scene."""
        return all((row - other) % len(one) == 0 for one in (self._scenes, self._arguments))

    def __str__(self) -> str:
        first = self._scenes[0]
        if isinstance(first, Scene):
            name = "a scene"
        elif isinstance(first, (str, os.PathLike)):
            name = Path(first).name
        else:
            name = getattr(first, "__name__", "a scene")
        return name if len(self._scenes) == 1 else f"{name} and {len(self._scenes) - 1} more"
