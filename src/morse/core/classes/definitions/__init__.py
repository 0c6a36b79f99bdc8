"""An index of the classes in the files of the package.

Reading the definitions from the text of a hundred files takes as long as importing numpy. The index is written when the
package is built. Its keys are digests of the files: a file that was changed later is not in the index, and is read
itself.
"""

from __future__ import annotations

import ast
import hashlib
import marshal
from dataclasses import astuple, dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.core.values import Value


@dataclass(frozen=True, slots=True)
class Definition:
    """A class in a file.

    Attributes:
        name: name of the class.
        doc: its docstring, or None.
        bases: the class paths of its base classes as far as the file says: relative to the file for a class of the
            same file (``.Name``) and for a relative import.
        attributes: the attributes in its body whose values are plain literals.
        defaults: the literal arguments of each call of ``..Defaults(...)`` assigned to ``_builder`` and ``_products``.
    """

    name: str
    doc: str | None
    bases: tuple[str, ...]
    attributes: dict[str, Value]
    defaults: dict[str, list[dict[str, Value]]]


def definitions(text: bytes, name: str) -> list[Definition]:
    """The public classes in the text of a file.

    Args:
        text: content of the file.
        name: name of the file, for error messages.

    Raises:
        SyntaxError: the text is not valid Python.
    """
    tree = ast.parse(text, name)
    imports = dict(_imported(tree))
    classes = (statement for statement in tree.body if isinstance(statement, ast.ClassDef))
    return [_definition(cls, imports) for cls in classes if not cls.name.startswith("_")]


def _imported(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """The names that a file imports, and their class paths."""
    for statement in tree.body:
        if isinstance(statement, ast.ImportFrom):
            # a file is the module "." of its package: an import from "." is one level above
            module = "." * (statement.level + 1 if statement.level else 0) + (statement.module or "")
            for name in statement.names:
                yield name.asname or name.name, f"{module.removesuffix('.')}.{name.name}"
        elif isinstance(statement, ast.Import):
            for name in statement.names:
                yield (
                    name.asname or name.name.partition(".")[0],
                    (name.name if name.asname else name.name.partition(".")[0]),
                )


def _base(base: ast.expr, imports: Mapping[str, str]) -> str:
    first, dot, rest = ast.unparse(base).partition(".")
    return f"{imports.get(first, f'.{first}')}{dot}{rest}"


def _definition(cls: ast.ClassDef, imports: Mapping[str, str]) -> Definition:
    return Definition(
        cls.name,
        ast.get_docstring(cls),
        tuple(_base(base, imports) for base in cls.bases),
        _literals(_assignments(cls)),
        {name: list(_declared_defaults(cls, name)) for name in ("_builder", "_products")},
    )


def _assignments(definition: ast.ClassDef) -> Iterator[tuple[str, ast.expr]]:
    for statement in definition.body:
        if isinstance(statement, ast.Assign):
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    yield target.id, statement.value
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and statement.value:
            yield statement.target.id, statement.value


def _literals(values: Iterator[tuple[str, ast.expr]]) -> dict[str, Value]:
    literals = {}
    for name, value in values:
        try:
            literals[name] = ast.literal_eval(value)
        except (ValueError, TypeError):
            continue
    return literals


def _declared_defaults(cls: ast.ClassDef, attribute: str) -> Iterator[dict[str, Value]]:
    for name, value in _assignments(cls):
        if name == attribute:
            calls = value.elts if isinstance(value, (ast.Tuple, ast.List)) else [value]
            yield from (_arguments(call) for call in calls if isinstance(call, ast.Call))


def _arguments(call: ast.Call) -> dict[str, Value]:
    function = call.func.id if isinstance(call.func, ast.Name) else ""
    # the first argument without a keyword: the name of a product, the model of a robot
    first = "model" if function == "RobotDefaults" else "name"
    arguments = [(first, value) for value in call.args[:1]]
    arguments += [(keyword.arg, keyword.value) for keyword in call.keywords if keyword.arg is not None]
    return _literals(iter(arguments))


#: file name of the index, in the directory of this file
FILE = Path(__file__).with_name("classes.index")
#: version of the format of `marshal`, which Python 3.4 and later read
_VERSION = 4


def indexed(file: Path) -> list[Definition]:
    """The public classes in a file, from the index if it contains the file.

    Raises:
        OSError: the file cannot be read.
        SyntaxError: the file is not valid Python.
    """
    text = read_regular(file)
    entry = _index().get(_digest(text))
    if entry is None:
        return definitions(text, str(file))
    return [Definition(*fields) for fields in marshal.loads(entry)]


def write(files: Iterable[Path], index: Path = FILE) -> None:
    """Write the index of files.

    Raises:
        OSError: a file cannot be read, or the index cannot be written.
        SyntaxError: a file is not valid Python.
    """
    texts = [(file, file.read_bytes()) for file in sorted(files)]
    entries = {_digest(text): _packed(definitions(text, str(file))) for file, text in texts}
    index.write_bytes(marshal.dumps(entries, _VERSION))


@cache
def _index() -> dict[bytes, bytes]:
    try:
        data = marshal.loads(FILE.read_bytes())
    except (OSError, ValueError, EOFError, TypeError):
        # before the package is built there is no index, and each file is read
        return {}
    return data if isinstance(data, dict) else {}


def _packed(entries: list[Definition]) -> bytes:
    return marshal.dumps([astuple(one) for one in entries], _VERSION)


def _digest(text: bytes) -> bytes:
    return hashlib.blake2b(text, digest_size=16, key=_program()).digest()


@cache
def _program() -> bytes:
    """A digest of the program that writes and reads the index, because another program may define other entries."""
    return hashlib.blake2b(Path(__file__).read_bytes()).digest()
