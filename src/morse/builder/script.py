"""Runs a scene script."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from morse import mathutils
from morse.assets import search
from morse.assets.formats import SUFFIXES
from morse.builder import workspace
from morse.builder.errors import ScriptError
from morse.builder.explain import explain
from morse.builder.finalise import build_scene
from morse.builder.libraries import LibrariesFirst

if TYPE_CHECKING:
    from morse.scene import Scene
    from morse.simulation.options import RunOptions

__all__ = ["ScriptError", "is_loading", "load_scene"]

_loading = False


def is_loading() -> bool:
    """True while a scene script runs: a program that is also a scene script can ask for it."""
    return _loading


def _offer_mathutils() -> None:
    """Scripts and components of 1.4 import ``mathutils``, which came with the Blender that ran them."""
    spec = importlib.util.find_spec("mathutils")
    # a folder of that name on the path is no module
    if spec is None or spec.origin is None:
        sys.modules["mathutils"] = mathutils


def load_scene(options: RunOptions) -> Scene:
    """Run a scene script and return the scene that it describes.

    ``sys.path`` and ``sys.argv`` are set for the script, and stay so for the components that it
    names.

    Raises:
        ScriptError: whatever is wrong with the script.
    """
    global _loading
    script = Path(options.script).absolute()
    search.set_project_dirs(options.resource_paths)
    directories = [*options.source_paths, str(script.parent)]
    _extend_path(directories)
    LibrariesFirst(script.stem, directories).install()
    sys.argv[:] = [str(script), *options.arguments]
    _offer_mathutils()
    workspace.reset()
    _loading = True
    try:
        if script.suffix.lower() in SUFFIXES:
            _make_environment(script)
        else:
            _run(script)
        return build_scene(workspace.current())
    except ScriptError as error:
        error.script = error.script or str(script)
        raise
    except Exception as error:
        raise explain(error, str(script)) from error
    finally:
        _loading = False


def _extend_path(directories: list[str]) -> None:
    for directory in reversed(directories):
        if directory in sys.path:
            sys.path.remove(directory)
        sys.path.insert(0, directory)


def _run(script: Path) -> None:
    source = script.read_bytes()
    code = compile(source, str(script), "exec", dont_inherit=True)
    module = ModuleType("__main__")
    module.__file__ = str(script)
    before = sys.modules["__main__"]
    # classes of the script look their module up by name
    sys.modules["__main__"] = module
    try:
        exec(code, module.__dict__)
    except SystemExit as leaving:
        if leaving.code not in (None, 0):
            raise explain(leaving, str(script)) from leaving
    finally:
        sys.modules["__main__"] = before
    workspace.current().script = module


def _make_environment(model: Path) -> None:
    from morse.builder.environment import Environment

    Environment(str(model))
