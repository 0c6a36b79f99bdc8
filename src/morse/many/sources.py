"""The code that the runs of a study execute: how other processes find it, and what names the runs."""

from __future__ import annotations

import ast
import hashlib
import importlib
import importlib.util
import inspect
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


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
    """Return the SHA-256 of the code of functions and scripts, with the modules beside them that they import."""
    files: dict[Path, None] = {}
    digest = hashlib.sha256()
    for part in parts:
        file = _file_of(part)
        if file is None:
            digest.update(_text_of(part))
        else:
            _collect(file, files)
    for file in sorted(files):
        digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()


def _file_of(part: object) -> Path | None:
    if isinstance(part, (str, os.PathLike)):
        return Path(part).resolve()
    file = getattr(getattr(part, "__code__", None), "co_filename", "")
    return Path(file).resolve() if file and Path(file).is_file() else None


def _text_of(part: Any) -> bytes:
    code = getattr(part, "__code__", None)
    if code is not None:
        try:
            return inspect.getsource(part).encode()
        except (OSError, TypeError):
            return bytes(code.co_code) + repr(code.co_consts).encode()
    return repr(type(part)).encode()


def _collect(file: Path, files: dict[Path, None]) -> None:
    if file in files or not file.is_file():
        return
    files[file] = None
    if file.suffix != ".py":
        return
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, ValueError):
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
