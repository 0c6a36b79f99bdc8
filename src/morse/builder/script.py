"""Runs a scene script, or a function that builds a scene."""

from __future__ import annotations

import logging
import sys
import threading
import warnings
from contextlib import contextmanager
from importlib.machinery import PathFinder
from pathlib import Path
from types import CodeType, ModuleType
from typing import TYPE_CHECKING

from morse.assets import search
from morse.assets.formats import is_model
from morse.builder import compatibility, workspace
from morse.builder.assembly.finalise import build_scene
from morse.builder.derive import installed_classes
from morse.builder.errors import ScriptError
from morse.builder.errors.explain import explain
from morse.builder.names import frames
from morse.builder.names.project_files import resource_folders, source_folders
from morse.core.classes.project_imports import ProjectImports
from morse.scene import SourceLine
from morse.scene.scene_warnings import about, scene_warnings
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from importlib.machinery import ModuleSpec

    from morse.scene import Scene
    from morse.simulation.options import RunOptions


class LibrariesFirst:
    """Finds libraries although the directory of the scene script comes first on the path.

    Otherwise, a script ``random.py`` or ``rich.py`` would be executed again instead of the library at each import.

    Args:
        script: name of the scene script, without suffix; it is never imported.
        directories: other directories whose files do not hide the standard library.
    """

    def __init__(self, script: str, directories: Iterable[str]) -> None:
        self._script = script
        self._directories = list(directories)

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        if path is not None or (name != self._script and name not in sys.stdlib_module_names):
            return None
        if PathFinder.find_spec(name, self._directories) is None:
            return None  # no file hides the library
        hiding = {Path(directory).resolve() for directory in self._directories}
        spec = PathFinder.find_spec(name, [entry for entry in sys.path if Path(entry).resolve() not in hiding])
        # a folder of that name is not a library
        return None if spec is None or spec.loader is None else spec


__all__ = ["ScriptError", "build", "is_loading", "load_scene"]

logger = logging.getLogger(__name__)

#: lock for the builder, which can describe one scene at a time
_describing = threading.RLock()
_loading = False


def is_loading() -> bool:
    """Whether a scene script is running, for programs that are also scene scripts."""
    return _loading


def load_scene(options: RunOptions, *, anew: bool = False, code: CodeType | None = None) -> Scene:
    """Run a scene script and return the scene that it describes.

    The script and its components have a separate ``sys.path``, ``sys.argv`` and modules: see
    `morse.core.classes.project_imports`. They are stored in the attribute ``project`` of the scene.

    Args:
        anew: whether to ignore cached compiled files, because the sources may have been saved a moment ago.
        code: what is executed instead of the file.

    Raises:
        ScriptError: the script has an error.
    """
    script = Path(options.script).absolute()
    directories = list(dict.fromkeys([*options.source_paths, *source_folders(script)]))
    libraries = LibrariesFirst(script.stem, directories)
    words = compatibility.first("arguments", script, options.arguments, directories)
    modules = [entry.modules() for entry in compatibility.installed()]

    builders: list[ModuleType] = []

    def as_imported(module: ModuleType) -> ModuleType:
        if module.__name__ == "morse.builder":
            if not builders:
                builders.append(_with_components_of_project(module))
            module = builders[0]
        for more in modules:
            module = more.as_imported(module)
        return module

    project = ProjectImports(
        directories,
        words or [str(script), *options.arguments],
        [libraries, *(finder for more in modules for finder in more.finders)],
        from_source=anew,
        as_imported=as_imported,
        names={name: value for more in modules for name, value in more.names.items()},
    )
    for more in modules:
        for name, module in more.offered.items():
            project.offer(name, module)

    def describe() -> None:
        if is_model(script):
            _make_environment(script)
        else:
            _run(script, project, code)

    try:
        with project:
            scene = build(describe, str(script), options.resource_paths, options.interfaces, resource_folders(script))
    finally:
        for more in modules:
            more.close()
    scene.project = project
    return scene


def build(
    describe: Callable[[], object],
    script: str = "",
    resource_paths: list[str] | None = None,
    interfaces: Sequence[str] = (),
    nearby: Sequence[str] = (),
) -> Scene:
    """Return the scene that a function describes with `morse.builder`.

    Args:
        script: name of the scene in error messages.
        resource_paths: directories searched for models before ``MORSE_RESOURCE_PATH``.
        interfaces: middlewares to which all components are connected, in addition to those of the scene.
        nearby: directories that only the script and the program search, after `resource_paths`; clients do not.

    Raises:
        ScriptError: the script has an error.
    """
    global _loading
    resource_names = resource_paths or []
    with (
        _describing,
        scene_warnings(),
        search.project_dirs([*resource_names, *nearby]),
        workspace.described() as described,
    ):
        before, _loading = _loading, True
        try:
            with about(frames.source_line):
                describe()
            if described.environment is not None:
                for interface in interfaces:
                    described.environment.add_default_interface(interface)
            scene = build_scene(described)
        except ScriptError as error:
            error.script = error.script or script
            raise
        except (KeyboardInterrupt, SystemExit):
            raise
        # a script may raise errors of any class
        except BaseException as error:
            raise explain(error, script) from error
        finally:
            _loading = before
    scene.resource_paths, scene.nearby_paths = list(resource_names), list(nearby)
    return scene


frames.begins_script(build)


@contextmanager
def describing(resource_paths: list[str]) -> Iterator[None]:
    """Within the block, a part of a scene can be described, with the models of a project."""
    with _describing, search.project_dirs(resource_paths):
        yield


def compiled(source: bytes | str, name: str) -> CodeType:
    """The code of a script; what Python warns of, such as ``n is 3``, is a warning about the scene.

    Raises:
        SyntaxError: the script has an error.
    """
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("always", SyntaxWarning)
        code = compile(source, name, "exec", dont_inherit=True)
    for one in noted:
        if issubclass(one.category, SyntaxWarning):
            logger.warning("%s: %s", one.category.__name__, one.message, extra={"where": SourceLine(name, one.lineno)})
    return code


def _run(script: Path, project: ProjectImports, code: CodeType | None) -> None:
    if code is None:
        code = compiled(read_regular(script), str(script))
    module = ModuleType("__main__")
    module.__file__ = str(script)
    project.prepare(module)
    before = sys.modules["__main__"]
    # classes of the script look up their module by name
    sys.modules["__main__"] = module
    try:
        exec(code, module.__dict__)
    except SystemExit as leaving:
        if leaving.code not in (None, 0):
            raise explain(leaving, str(script)) from leaving
    finally:
        sys.modules["__main__"] = before
    workspace.current().script = module


def _with_components_of_project(builder: ModuleType) -> ModuleType:
    """The names for scripts, with those of the components that the project on the import path declares.

    The module of the process stays as it is: other scenes have other projects.
    """
    classes = installed_classes(builder.__name__, builder._points)
    for name in [name for name in classes if hasattr(builder, name) and name not in builder._packaged]:
        logger.warning("%s of the project is left out: MORSE has a class of that name", name)
        del classes[name]
    if not classes:
        return builder
    module = ModuleType(builder.__name__, builder.__doc__)
    vars(module).update(vars(builder), **classes, __all__=list(dict.fromkeys([*builder.__all__, *classes])))
    return module


def _make_environment(model: Path) -> None:
    from morse.builder.environment import Environment

    Environment(str(model))
