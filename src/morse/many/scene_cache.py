"""Scenes that are loaded again and again in one process, whose physics is compiled once."""

from __future__ import annotations

import copyreg
import hashlib
import io
import pickle
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from morse.launch.load import described, resolve, start
from morse.physics.model.compile import Compiled, compile_scene
from morse.scene import CollisionShape, Image, Mesh
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Sequence

    from morse.scene import Scene
    from morse.simulation.simulation import Simulation

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
