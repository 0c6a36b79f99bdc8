"""The scenes of the rows of a batch, and those that are loaded again and again, whose physics is compiled once."""

from __future__ import annotations

import copyreg
import hashlib
import io
import math
import os
import pickle
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import nearest
from morse.launch.load import described, load, resolve, start
from morse.physics.model.compile import Compiled, compile_scene
from morse.scene import CollisionShape, Image, Mesh, Scene
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator, Sequence

    from morse.core.values import Options
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View

#: number of scenes that are kept, the latest ones
_MOST = 4


@dataclass
class _Kept:
    """A scene that was loaded before.

    Attributes:
        built: digest of the scene as its script has described it.
        options: of its simulations.
        scene, compiled: used by later simulations; None until the script has described the same scene twice.
        begun: digest of this scene before its first simulation.
    """

    built: str
    options: RunOptions
    scene: Scene | None = None
    compiled: Compiled | None = None
    begun: str = ""


class SceneCache:
    """Loads scenes as `morse.load` does, with the same data, in a fraction of the time from the third time on.

    The first two times, the script describes its scene. If both descriptions are equal, later simulations are new
    objects around a copy of the model that was compiled for the second. What a run has changed in the scene itself is
    noticed: the scene is then loaded anew. So is, each time, a scene that its script describes at random, or with
    components of the user, whose modules may keep something from run to run.
    """

    def __init__(self) -> None:
        self._scenes: dict[Hashable, _Kept] = {}

    @contextmanager
    def load(self, key: Hashable, scene: object, seed: int, arguments: Sequence[str] = ()) -> Iterator[Simulation]:
        """Load a scene for one run, with ``on_failure="raise"``; the simulation is closed afterwards.

        Args:
            key: of the scene and its arguments.
            scene, seed, arguments: see `morse.load`.
        """
        # until the run has ended, the scene is not known to be unchanged
        entry = self._scenes.pop(key, None)
        if entry is not None and entry.scene is not None and entry.compiled is not None:
            simulation = start(entry.scene, replace(entry.options, seed=seed), entry.compiled.copy())
        else:
            simulation, entry = _loaded(entry, scene, seed, arguments)
        with simulation:
            yield simulation
        if entry.scene is not None:
            if simulation.world.arrangement:
                return
            if _digest(entry.scene) != entry.begun:
                # restores colours and lamps
                simulation.world.reset()
                if _digest(entry.scene) != entry.begun:
                    return
        self._scenes[key] = entry
        while len(self._scenes) > _MOST:
            del self._scenes[next(iter(self._scenes))]


def _loaded(before: _Kept | None, scene: Any, seed: int, arguments: Sequence[str]) -> tuple[Simulation, _Kept]:
    """Return a simulation of a scene that its script describes, and what is kept of it."""
    options = RunOptions(arguments=list(arguments), sockets=False, view="none", open_browser=False, on_failure="raise")
    description = described(scene, options)
    entry = _Kept(_digest(description, whole=True), options)
    model = None
    if before is not None and before.built == entry.built and _is_of_morse(description):
        resolve(description)
        entry.scene, entry.compiled = description, compile_scene(description)
        entry.begun = _digest(description)
        model = entry.compiled.copy()
    return start(description, replace(options, seed=seed), model), entry


def _is_of_morse(scene: Scene) -> bool:
    """Whether all components and modifiers are classes of MORSE."""
    paths = [component.classpath for component in scene.components]
    paths += [modifier.classpath for component in scene.components for modifier in component.modifiers]
    return all(path.partition(".")[0] == "morse" for path in [*paths, *scene.managers()])


def _digest(scene: Scene, *, whole: bool = False) -> str:
    """The digest of a scene; of meshes and images, which do not change, only if it is to be the whole one."""
    file = io.BytesIO()
    pickler = pickle.Pickler(file, protocol=5)
    kinds = [type(scene.project), *(() if whole else (Mesh, CollisionShape, Image))]
    pickler.dispatch_table = {**copyreg.dispatch_table, **dict.fromkeys(kinds, _left_out)}
    pickler.dump(scene)
    return hashlib.sha256(file.getbuffer()).hexdigest()


def _left_out(part: object) -> tuple[Any, ...]:
    return type, (None,)


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

    def load(self, row: int, seed: int | None, label: str | None = None) -> Simulation:
        """Load the simulation of a row; errors name the row.

        Args:
            label: see ``file_label`` of `morse.load`.
        """
        scene, arguments = self._scenes[row % len(self._scenes)], self._arguments[row % len(self._arguments)]
        try:
            return load(scene, seed=seed, arguments=arguments, file_label=label, **self._options)
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
            arguments=list(arguments),
            sockets=False,
            view="web",
            view_port=port,
            open_browser=False,
            speed=math.inf,
            file_label=None,
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
