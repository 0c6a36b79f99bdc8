"""Scene scripts from the functions of tests."""

from __future__ import annotations

import ast
import inspect
import os
import re
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import suffixes
from morse.testing.exceptions import MorseTestingError

if TYPE_CHECKING:
    from collections.abc import Callable

_IMPORTS = """\
from morse.builder import *
from morse.builder.actuators import *
from morse.builder.sensors import *

class MyEnv():
"""


def script_of_method(method: Callable[..., object], time_strategy: str, *, physics_of_1_4: bool = False) -> str:
    """Return a scene script from a method that builds a scene with the names of ``morse.builder``.

    The source of the method is copied verbatim: it can use the names of the builder, but no names of its own module. It
    has to assign the environment to a variable ``env``.

    Args:
        time_strategy: ``BestEffort`` or ``FixedSimulationStep``.
        physics_of_1_4: whether driven robots are as slow as in MORSE 1.4.

    Raises:
        MorseTestingError: the source is not available.
    """
    try:
        source = inspect.getsource(method)
    except (OSError, TypeError) as error:
        raise MorseTestingError(
            f"{method.__qualname__} has no source from which a scene can be created: {error}"
        ) from None
    if not source[0].isspace():
        source = textwrap.indent(source, "    ")
    text = _IMPORTS + source.rstrip() + "\n"
    settings = [f"env.set_time_strategy(TimeStrategies.{time_strategy})"]
    if physics_of_1_4:
        settings.append("env.use_physics_of_1_4()")
    lines = "".join(f"{_indentation(text)}{setting}\n" for setting in settings)
    return f"{text}{lines}\n{_instance(method)}\n"


def _instance(method: Callable[..., object]) -> str:
    return f"MyEnv().{method.__name__}()"


def _indentation(text: str) -> str:
    """The indentation of the statements of the only method of the only class."""
    (cls,) = (node for node in ast.parse(text).body if isinstance(node, ast.ClassDef))
    method = cls.body[0]
    assert isinstance(method, ast.FunctionDef)
    first = method.body[0]
    line = text.splitlines()[first.lineno - 1]
    blanks = line[: len(line) - len(line.lstrip())]
    if first.lineno == method.lineno:
        raise MorseTestingError(f"{method.name} has to be written in several lines, and has to assign 'env'")
    return blanks


def script_of_function(function: Callable[[], object]) -> str:
    """Return a scene script that imports the module of a function and calls the function.

    Raises:
        MorseTestingError: the function cannot be imported: it is nested in another function, or is not in a file.
    """
    module = sys.modules.get(function.__module__)
    file = getattr(module, "__file__", None)
    if file is None or "<locals>" in function.__qualname__ or "<lambda>" in function.__qualname__:
        raise MorseTestingError(
            f"{function.__qualname__} cannot be run in another process: define the scene as a function of a module"
        )
    return (
        "import importlib.util\nimport sys\n"
        f"sys.path += [path for path in {sys.path!r} if path not in sys.path]\n"
        f"spec = importlib.util.spec_from_file_location({function.__module__!r}, {str(Path(file).resolve())!r})\n"
        "module = importlib.util.module_from_spec(spec)\n"
        "sys.modules[spec.name] = module\n"
        "spec.loader.exec_module(module)\n"
        f"module.{function.__qualname__}()\n"
    )


#: statements of scenes; a path such as ``scenes/my-robot`` is an expression
_STATEMENTS = (
    ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Import, ast.ImportFrom, ast.For, ast.If, ast.With, ast.FunctionDef
)  # fmt: skip

#: the beginning of a statement that is not complete
_BEGINNING = re.compile(r"\s*[^\W\d]\w*\s*(=|\()")


def is_text(scene: str) -> bool:
    """Whether a string is the text of a scene, and not the path of one.

    A text has several lines; or it is not an existing file, does not end as a script does, and is or begins as a
    statement or a call.
    """
    if "\n" in scene:
        return True
    if scene.rstrip().lower().endswith((".py", *suffixes())) or os.path.exists(scene):
        return False
    try:
        body = ast.parse(scene.strip()).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return _BEGINNING.match(scene) is not None  # the error of a text is that of its line
    return any(
        isinstance(one, _STATEMENTS) or (isinstance(one, ast.Expr) and isinstance(one.value, ast.Call)) for one in body
    )


def script_of_text(text: str, *, elsewhere: bool = False) -> str:
    """Return a scene script from a text that may lack the import of the builder, and the environment.

    Args:
        elsewhere: whether another process runs it, which needs the import path of this one.
    """
    paths = f"import sys; sys.path += [path for path in {sys.path!r} if path not in sys.path]\n" if elsewhere else ""
    begin = "" if "from morse.builder import *" in text else "from morse.builder import *\n"
    end = "" if "Environment(" in text else '\nenv = Environment("empty")\n'
    return paths + begin + textwrap.dedent(text) + end
