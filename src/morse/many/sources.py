"""The code that the runs of a study execute: how other processes find it, and its digest, which names the runs."""

from __future__ import annotations

import ast
import contextlib
import hashlib
import importlib
import importlib.util
import inspect
import os
import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from types import CodeType, FunctionType, MethodType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.system.regular_files import open_regular, read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from types import CellType


class Reference(NamedTuple):
    """A function or an object of a module, for another process.

    Attributes:
        file: path of the file of the module.
        module: its name, if it is a part of a package; else empty.
        name: qualified name in the module.
    """

    file: str
    module: str
    name: str

    def load(self) -> Any:
        """Import the module, and return the object.

        Raises:
            ImportError, AttributeError: it does not exist any more.
        """
        source: object = imported(self.file, self.module)
        for part in self.name.split("."):
            source = getattr(source, part)
        return source


def reference_of(function: Callable[..., object]) -> Reference | None:
    """Return the reference of a function, or None if only this process has it: a function within a function."""
    module = sys.modules.get(getattr(function, "__module__", None) or "")
    name = getattr(function, "__qualname__", "")
    file = getattr(module, "__file__", None)
    if file is None or not name or "<" in name or not Path(file).is_file():
        return None
    target: object = module
    for part in name.split("."):
        target = getattr(target, part, None)
    if target is not function:
        return None
    package = module.__spec__.name if module is not None and module.__spec__ and module.__package__ else ""
    return Reference(str(Path(file).resolve()), package, name)


_loaded: dict[tuple[str, str], object] = {}


class StopLoading(BaseException):
    """Ends the execution of a script that starts its study without ``if __name__ == "__main__"``."""


#: whether a script is executed only for its functions
is_loading = False


def imported(file: str, module: str = "") -> object:
    """Return the module of a file, which is executed once; a study that it starts is not run."""
    global is_loading
    key = file, module
    if key in _loaded:
        return _loaded[key]
    if module:
        _loaded[key] = importlib.import_module(module)
        return _loaded[key]
    folder = os.path.dirname(file)
    if folder not in sys.path:
        sys.path.append(folder)
    name = f"morse_study_{hashlib.sha256(file.encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is not a Python file")
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    before, is_loading = is_loading, True
    try:
        spec.loader.exec_module(package)
    except StopLoading:
        pass
    except BaseException:
        del sys.modules[name]
        raise
    finally:
        is_loading = before
    _loaded[key] = package
    return package


def code_of(parts: Iterable[object]) -> str:
    """Return the SHA-256 of the code of functions, scenes and scripts, with the modules beside them that they import.

    Functions count with the values that they carry along: arguments of a `functools.partial`, defaults, variables of
    the function around them, attributes of an object that is called.
    """
    code = _Code()
    for part in parts:
        code.add(str(part) if isinstance(part, os.PathLike) else part, is_path=isinstance(part, (str, os.PathLike)))
    return code.hexdigest()


#: attributes that say where a callable object is
_PLACE = ("__module__", "__qualname__")


class _Code:
    """Collects what runs depend on: values in their order, and the files of functions."""

    def __init__(self) -> None:
        self._digest, self._files, self._seen = hashlib.sha256(), dict[Path, None](), dict[int, tuple[int, object]]()

    def hexdigest(self) -> str:
        """Return the digest of all."""
        digest = self._digest.copy()
        for file in sorted(self._files):
            with open_regular(file) as content:
                digest.update(file.name.encode() + b"\0" + content.read() + b"\0")
        return digest.hexdigest()

    def _note(self, *words: object) -> None:
        self._digest.update("\0".join(map(str, words)).encode("utf-8", "surrogatepass") + b"\1")

    def add(self, value: Any, *, is_path: bool = False) -> None:
        """Add a value."""
        kind = type(value)
        if is_path:
            _collect(Path(value).resolve(), self._files)
        elif kind is int:
            self._note("int", hex(value))  # which has no limit of digits
        elif value is None or kind in (bool, float, complex, str, bytes):
            self._note(kind.__name__, repr(value))
        elif isinstance(value, (np.ndarray, np.generic)):
            array = np.asarray(value)
            if array.dtype == object:
                self.add(array.tolist())
            else:
                self._note(array.dtype.str, array.shape, hashlib.sha256(array.tobytes()).hexdigest())
        elif isinstance(value, type):
            self._note("class", value.__qualname__)
        elif id(value) in self._seen:
            self._note("again", self._seen[id(value)][0])
        else:
            # the value is kept, so that no other one gets its number
            self._seen[id(value)] = len(self._seen), value
            self._add_object(value)

    def _add_object(self, value: object) -> None:
        kind = type(value)
        self._note(kind.__qualname__)
        if isinstance(value, Mapping):
            for key in sorted(value, key=_order):
                self.add(key)
                self.add(value[key])
        elif isinstance(value, (set, frozenset)):
            self._each(sorted(value, key=_order))
        elif isinstance(value, (list, tuple)):
            self._each(value)
        elif isinstance(value, Enum):
            self._note(value.name)
        elif isinstance(value, os.PathLike):
            self._note(os.fspath(value))
        elif isinstance(value, partial):
            self._each([value.func, value.args, value.keywords])
        elif isinstance(value, MethodType):
            self._each([value.__func__, value.__self__])
        elif isinstance(value, FunctionType):
            self._add_function(value)
        elif is_dataclass(value):
            # what lies around a scene, such as the modules of its project, is the same in all scenes of a script
            self._each([getattr(value, field.name) for field in fields(value) if field.name != "project"])
        elif callable(value):
            self._add_class(kind)
            # where other processes find it is not what it does
            self.add({k: v for k, v in getattr(value, "__dict__", {}).items() if k not in _PLACE})

    def _each(self, values: Iterable[object]) -> None:
        for value in values:
            self.add(value)
        self._note("end")

    def _add_class(self, kind: type) -> None:
        file = getattr(sys.modules.get(kind.__module__), "__file__", None)
        if file is not None:
            self.add(file, is_path=True)
            return
        self._each(function for function in vars(kind).values() if isinstance(function, FunctionType))

    def _add_function(self, function: FunctionType) -> None:
        code = function.__code__
        constants = [constant for constant in code.co_consts if not isinstance(constant, CodeType)]
        self._note(function.__qualname__, code.co_code.hex(), code.co_names, code.co_varnames)
        self._each(
            [constants, function.__defaults__, function.__kwdefaults__, *map(_content, function.__closure__ or ())]
        )
        if Path(code.co_filename).is_file():
            self.add(code.co_filename, is_path=True)
        else:  # a cell of a notebook: what it uses of other cells
            with contextlib.suppress(OSError, TypeError):
                self._note(inspect.getsource(function))
            used = {name: function.__globals__.get(name) for name in code.co_names}
            self.add({name: value for name, value in used.items() if _is_of(function.__module__, value)})
        if (wrapped := getattr(function, "__wrapped__", None)) is not None:
            self.add(wrapped)


def _order(value: object) -> str:
    """What sorts the elements of a set in the same way in each process."""
    return f"{type(value).__name__} {value:x}" if type(value) is int else repr(value)


def _is_of(module: str, value: object) -> bool:
    """Whether a value that a function uses is none of a library."""
    return isinstance(value, (bool, int, float, str, list, tuple, dict)) or getattr(value, "__module__", "") == module


def _content(cell: CellType) -> object:
    try:
        return cell.cell_contents
    except ValueError:  # a variable that has no value yet
        return None


def _collect(file: Path, files: dict[Path, None]) -> None:
    if file in files or not file.is_file():
        return
    files[file] = None
    if file.suffix != ".py":
        return
    try:
        tree = ast.parse(read_regular(file))
    except (SyntaxError, ValueError, OSError):
        return  # the run reports it
    for name in _imports(tree):
        for folder in (file.parent, file.parent / "src"):
            place = folder.joinpath(*name.split("."))
            for candidate in (place.with_suffix(".py"), place / "__init__.py"):
                _collect(candidate, files)


def _imports(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
        elif isinstance(node, ast.ImportFrom) and node.level <= 1:
            if node.module:
                yield node.module
            yield from (f"{node.module}.{alias.name}" if node.module else alias.name for alias in node.names)
