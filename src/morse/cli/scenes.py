"""Finds the scene file for ``morse run`` and ``morse edit``, and the directories of its project."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.formats import is_model
from morse.cli.messages import CommandError, nearest, warn
from morse.cli.sites import Sites
from morse.simulation.options import RunOptions
from morse.system.regular_files import open_regular

if TYPE_CHECKING:
    from collections.abc import Sequence

_DEFAULT_SCENE = "default.py"
_SCENE_SUFFIXES = (".py", ".blend")
_RECORDING = ".mcap"
_BUILDER = b"morse.builder"
#: bytes of a script that are searched
_LARGEST = 1_000_000
_OF_PYTEST = re.compile(r"conftest\.py|test_.*\.py|.*_test\.py")


@dataclass(frozen=True, slots=True)
class ResolvedScene:
    """A scene to run.

    Attributes:
        script: absolute path of the scene script or ``.blend`` file.
        arguments: the words after the scene on the command line, for the script.
        project: directory of the environment to which it belongs, or None.
    """

    script: Path
    arguments: list[str] = field(default_factory=list)
    project: Path | None = None

    @property
    def source_paths(self) -> list[str]:
        """The folder of the Python packages of the project."""
        return self._folders("src")

    @property
    def resource_paths(self) -> list[str]:
        """The folder of the models of the project."""
        return self._folders("data")

    def options(self, **others: Any) -> RunOptions:
        """The options of a run of the scene; ``others`` are those that do not follow from the scene."""
        return RunOptions(
            script=str(self.script),
            arguments=self.arguments,
            source_paths=self.source_paths,
            resource_paths=self.resource_paths,
            **others,
        )

    def _folders(self, name: str) -> list[str]:
        return [str(self.project / name)] if self.project is not None and (self.project / name).is_dir() else []


def resolve(words: Sequence[str]) -> ResolvedScene:
    """Find the scene of a command line.

    Args:
        words: ``[ENVIRONMENT [FILE]]`` or ``[PATH]``, then the arguments of the script.

    Raises:
        CommandError: there is no such scene.
    """
    sites, broken = Sites.or_none_registered()
    if broken is not None:
        if not Path(words[0] if words else _DEFAULT_SCENE).exists():
            raise broken
        warn(f"{broken} Until then, environments cannot be found by name.")
    if not words:
        return _scene_here(sites)
    first, rest = words[0], list(words[1:])
    name = first.rstrip("/" + os.sep) or first
    if name in sites:
        return _scene_of_environment(sites.directory(name), name, rest)
    path = Path(first).absolute()
    if path.is_dir():
        return _scene_of_environment(path, first, rest)
    if not path.is_file():
        raise _unknown_scene(first, path, sites)
    if path.suffix == _RECORDING:
        raise CommandError(f"'{first}' is a recording, not a scene. Show it with: morse replay {first}")
    return ResolvedScene(path, rest, _project_of(path, sites))


def _scene_here(sites: Sites) -> ResolvedScene:
    here = Path.cwd()
    if (here / _DEFAULT_SCENE).is_file():
        return _scene_of_environment(here, here.name, [])
    raise CommandError(
        f"Which scene? Give an environment or a scene script: morse run NAME, or morse run PATH. {sites.known()}",
        status=2,
    )


def _scene_of_environment(directory: Path, name: str, rest: list[str]) -> ResolvedScene:
    # arguments that begin with a dash are not files
    if rest and not rest[0].startswith("-"):
        return ResolvedScene(_file_of_environment(directory, name, rest[0]), rest[1:], directory)
    default = directory / _DEFAULT_SCENE
    if not default.is_file():
        scenes = _scenes_in(directory)
        if not scenes:
            raise CommandError(f"There is no scene (*.py or *.blend) in the environment '{name}', {directory}.")
        default = directory / scenes[0]
        warn(f"there is no {_DEFAULT_SCENE} in the environment '{name}': running {scenes[0]}.")
    return ResolvedScene(default, rest, directory)


def _file_of_environment(directory: Path, name: str, file: str) -> Path:
    for candidate in (directory / file, Path(file).absolute()):
        if candidate.is_file():
            return candidate
    scenes = _scenes_in(directory)
    raise CommandError(
        f"There is no file '{file}' in the environment '{name}' ({directory}) nor in the current "
        f"directory.{nearest(file, scenes)} Scenes of '{name}': {', '.join(scenes) or 'none'}. To pass '{file}' to "
        f"the script, give the script first: morse run {name} {_DEFAULT_SCENE} {file}"
    )


def _scenes_in(directory: Path) -> list[str]:
    files = (path for path in directory.iterdir() if path.suffix in _SCENE_SUFFIXES and path.is_file())
    scenes = [path for path in files if not _OF_PYTEST.fullmatch(path.name)]
    # clients and other programs beside the scenes are not scenes
    builders = [path for path in scenes if path.suffix == ".blend" or _names_the_builder(path)]
    return sorted(path.name for path in builders or scenes)


def _names_the_builder(script: Path) -> bool:
    """Whether a script may import the classes of scenes."""
    try:
        with open_regular(script) as file:
            return _BUILDER in file.read(_LARGEST)
    except OSError:
        return False


def _unknown_scene(name: str, path: Path, sites: Sites) -> CommandError:
    files = _scenes_in(path.parent) if path.parent.is_dir() else []
    hint = nearest(path.name, files) or nearest(name, sites.names())
    return CommandError(
        f"'{name}' is neither a registered environment nor a file ({path} does not exist).{hint} {sites.known()}"
    )


def _project_of(script: Path, sites: Sites) -> Path | None:
    """The environment that contains a script: a registered one, or a directory with ``src`` or ``data``.

    A model that is run as a scene is data, and brings no code of folders that the user has not registered.
    """
    if (owner := sites.owner(script)) is not None or is_model(script):
        return owner
    beside = script.parent
    return beside if (beside / "src").is_dir() or (beside / "data").is_dir() else None
