"""Limits of the expressions of a xacro file: they compute values, and read the files of the robot.

xacro evaluates them as Python without the built-in functions. That is no limit: an expression reaches every module of
the process through a frame, ``vars`` or ``type``, and ``$(eval ...)`` has the built-in functions.
"""

from __future__ import annotations

import builtins
import errno
import importlib
import io
import os
import sys
import types
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.nearby_files import find_near
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

#: of a file that an expression or ``xacro:include`` reads, bytes
_MOST_BYTES = 64 << 20
#: attributes that lead from a value to frames and code, such as ``gi_frame`` and ``f_back``
_INNER = frozenset(
    name
    for kind in (
        types.GeneratorType, types.CoroutineType, types.AsyncGeneratorType, types.FrameType, types.CodeType,
        types.TracebackType,
    )
    for name in dir(kind)
    if "_" in name
)  # fmt: skip
#: built-in functions within ``$(eval ...)``
_FUNCTIONS = {
    one.__name__: one for one in (abs, bool, dict, float, int, len, list, map, max, min, range, round, sorted, str, sum)
}
#: events of `sys.audit` that an expansion causes, of those that concern the system
_HARMLESS = ("os.listdir", "os.scandir")
_SYSTEM = ("os", "subprocess", "socket", "ctypes", "shutil", "signal", "pty", "tempfile", "webbrowser", "urllib")
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def limit(model: Path, packages: Sequence[Path]) -> None:
    """Limit xacro in this process, for good.

    Args:
        model: the file that is expanded.
        packages: folders whose files may be read in addition to those near the model; may grow later.
    """
    import xacro
    from xacro import substitution_args

    importlib.import_module("yaml")  # xacro imports it within an expression

    def opened(name: str, *_: object) -> io.TextIOWrapper:
        return io.TextIOWrapper(io.BytesIO(read_regular(_allowed(name, model, packages), _MOST_BYTES)), "utf-8")

    for module in (xacro, substitution_args):
        # names of a module come before those of builtins
        vars(module).update(eval=evaluate, open=opened)
    for table in (xacro._global_symbols, xacro._global_symbols.get("python", {})):
        table.pop("vars", None)
        if "type" in table:
            table["type"] = lambda value: type(value)
    sys.dont_write_bytecode = True
    sys.addaudithook(_watch)


def evaluate(
    expression: str | types.CodeType, symbols: dict[str, Any], names: Mapping[str, object] | None = None
) -> object:
    """Return the value of an expression, as `eval` does, without a way to the rest of the process.

    Raises:
        ValueError: it uses a name of the inner parts of Python.
        Exception: any of the expression.
    """
    code = compile(expression.strip(), "<expression>", "eval") if isinstance(expression, str) else expression
    for name in _names(code):
        if name.startswith("__") or name in _INNER:
            raise ValueError(f"an expression cannot use '{name:.60}'")
    symbols.setdefault("__builtins__", _FUNCTIONS)
    return builtins.eval(code, symbols, names)


def _names(code: types.CodeType) -> Iterator[str]:
    """The global names and the attributes of an expression and of the functions within."""
    yield from code.co_names
    for value in code.co_consts:
        if isinstance(value, types.CodeType):
            yield from _names(value)


def _allowed(name: str, model: Path, packages: Sequence[Path]) -> Path:
    path = Path(os.path.abspath(name))
    real = Path(os.path.realpath(path))
    if real.is_file() and any(real.is_relative_to(os.path.realpath(folder)) for folder in packages):
        return path
    if not path.exists():  # xacro:include may say that a file is optional
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    return find_near(f"file://{path}", model)


def _watch(event: str, values: tuple[Any, ...]) -> None:
    """The second limit: whatever code runs, it writes no file, starts no program and opens no connection."""
    if event == "open":
        refused = bool(values[2] & _WRITES)
    else:
        refused = event.partition(".")[0] in _SYSTEM and event not in _HARMLESS
    if refused:
        raise PermissionError(f"an expression cannot cause '{event}'")
