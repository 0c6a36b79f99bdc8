"""The program that expands files of xacro: ``python -m morse.assets.urdf.xacro_program``.

xacro evaluates the expressions of a file as Python without the built-in functions. That is no limit: an expression
reaches every module of the process through a frame, ``vars``, ``type`` or ``str.format``, and ``$(eval ...)`` has the
built-in functions. Here, an expression consists of the nodes and functions that are listed, and has only the listed
members of plain values.

This process has a limit of time and memory, and none of the environment variables of the user. The question is an
object in JSON with ``path`` and ``arguments``, the answer one with ``text`` or ``error``.
"""

from __future__ import annotations

import ast
import builtins
import errno
import importlib
import io
import json
import os
import string
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.assets.nearby_files import FileRefusedError, find_near, find_package
from morse.system.regular_files import read_regular
from morse.system.workers import Server, limit_resources, serve_program

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


#: of the expansion of a file, s
TIME_LIMIT = 30.0
#: of its process, bytes
MOST_MEMORY = 2 << 30
#: of a file that an expression or ``xacro:include`` reads, bytes
_MOST_BYTES = 64 << 20
#: the syntax of expressions; operators and contexts of names are allowed as well
_NODES = (
    ast.Expression, ast.Constant, ast.Name, ast.Attribute, ast.Subscript, ast.Slice, ast.Call, ast.keyword, ast.Starred,
    ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.List, ast.Tuple, ast.Dict, ast.Set, ast.ListComp,
    ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.comprehension, ast.Lambda, ast.arguments, ast.arg, ast.JoinedStr,
    ast.FormattedValue, ast.operator, ast.unaryop, ast.boolop, ast.cmpop, ast.expr_context,
)  # fmt: skip
_NUMBERS = frozenset(("real", "imag", "conjugate", "is_integer"))
_LISTS = frozenset(("count", "index"))
#: members of values; texts have ``format`` as well
_MEMBERS: dict[type, frozenset[str]] = {
    str: frozenset(name for name in dir(str) if name[0] != "_") - {"encode", "format", "format_map", "maketrans"},
    float: _NUMBERS,
    int: _NUMBERS,
    complex: _NUMBERS,
    list: _LISTS,
    tuple: _LISTS,
    dict: frozenset(("copy", "get", "items", "keys", "values")),
    set: frozenset(("difference", "intersection", "issubset", "issuperset", "union")),
}
#: built-in functions within ``$(eval ...)``
_FUNCTIONS = {
    one.__name__: one for one in (abs, bool, dict, float, int, len, list, map, max, min, range, round, sorted, str, sum)
}
#: functions of ``${...}``, and those in its namespaces; all names of ``math`` belong to them
_PYTHON = frozenset((
    *_FUNCTIONS, "True", "False", "all", "any", "complex", "divmod", "enumerate", "filter", "frozenset", "isinstance",
    "issubclass", "ord", "repr", "reversed", "set", "slice", "tuple", "type", "zip",
))  # fmt: skip
_XACRO = frozenset((
    "abs_filename", "arg", "dotify", "error", "fatal", "load_yaml", "message", "print_location", "tokenize", "warning",
))  # fmt: skip
_TYPES = (bool, complex, dict, float, int, list, str, tuple)
#: what reads a member in the compiled expression; XML cannot contain such a name
_READ = "\0member"
#: events of `sys.audit` that an expansion causes, of those that concern the system
_HARMLESS = ("os.listdir", "os.scandir")
_SYSTEM = ("os", "subprocess", "socket", "ctypes", "shutil", "signal", "pty", "tempfile", "webbrowser", "urllib")
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def limit(model: Path, packages: Sequence[Path], variables: Mapping[str, str]) -> None:
    """Limit xacro in this process, for good.

    Args:
        model: the file that is expanded.
        packages: folders whose files may be read in addition to those near the model; may grow later.
        variables: what ``$(env NAME)`` and ``$(optenv NAME)`` find.
    """
    import xacro
    from xacro import substitution_args

    importlib.import_module("yaml")  # xacro imports it within an expression

    def opened(name: str, *_: object) -> io.TextIOWrapper:
        return io.TextIOWrapper(io.BytesIO(read_regular(_allowed(name, model, packages), _MOST_BYTES)), "utf-8")

    def required(name: str) -> str:
        if name not in variables:
            raise substitution_args.SubstitutionException(
                f"a file reads no environment variables: give its value, as in arguments={{'{name:.60}': ...}}"
            )
        return variables[name]

    def optional(name: str, default: str = "") -> str:
        return variables.get(name, default)

    # names of a module come before those of builtins
    vars(xacro).update(safe_eval=evaluate, open=opened)
    vars(substitution_args).update(eval=evaluate, open=opened, _eval_env=required, _eval_optenv=optional)
    substitution_args._eval_dict.update(env=required, optenv=optional)
    symbols = xacro._global_symbols
    for table, names in ((symbols.get("python", {}), _PYTHON), (symbols.get("xacro", {}), _XACRO)):
        for name in [name for name in table if name not in names]:
            del table[name]
    usual = {*_PYTHON, *_XACRO, *symbols.get("math", {}), "python", "xacro", "math"}
    for name in [name for name in symbols if name not in usual]:
        del symbols[name]
    for table in (symbols, symbols.get("python", {})):
        if "type" in table:
            table["type"] = _type
    sys.dont_write_bytecode = True
    sys.addaudithook(_watch)


def evaluate(expression: str, symbols: dict[str, object], names: Mapping[str, object] | None = None) -> object:
    """Return the value of an expression, as `eval` does, without a way to the rest of the process.

    Raises:
        ValueError: it uses another syntax, or a member or a name that is not allowed.
        Exception: any of the expression.
    """
    tree = _Limited().visit(ast.parse(expression.strip(), "<expression>", "eval"))
    code = compile(ast.fix_missing_locations(tree), "<expression>", "eval")
    symbols.update(__builtins__={**_FUNCTIONS, _READ: _member} if names is not None else {_READ: _member})
    return builtins.eval(code, symbols, names)


class _Limited(ast.NodeTransformer):
    """Refuses what is not listed; members are read by `_member`."""

    def generic_visit(self, node: ast.AST) -> ast.AST:
        if not isinstance(node, _NODES):
            raise _refused(type(node).__name__)
        for name in (getattr(node, "id", None), getattr(node, "arg", None), getattr(node, "attr", None)):
            if isinstance(name, str) and name.startswith("_"):
                raise _refused(name)
        return super().generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        self.generic_visit(node)
        return ast.Call(ast.Name(_READ, ast.Load()), [node.value, ast.Constant(node.attr)], [])


def _member(value: object, name: str) -> object:
    """The member of a value; an entry of what a YAML file contains, and of a namespace.

    Raises:
        ValueError: it is not listed.
    """
    import xacro

    if isinstance(value, xacro.NameSpace):
        return value[name]
    for kind, names in _MEMBERS.items():
        if isinstance(value, kind):
            if name in names:
                return getattr(value, name)
            if isinstance(value, xacro.YamlDictWrapper) and not hasattr(dict, name):
                return value[name]
            if isinstance(value, str) and name == "format":
                return lambda *args, **options: _Format().vformat(value, args, options)
    raise _refused(name)


class _Format(string.Formatter):
    """``str.format`` without members and items of the values: they would lead to all modules."""

    def get_field(self, field_name: str, args: Sequence[object], kwargs: Mapping[str, object]) -> tuple[Any, Any]:
        if not field_name.isalnum() and not field_name.isidentifier():
            raise _refused(field_name)
        field: tuple[object, object] = super().get_field(field_name, args, kwargs)
        return field


def _type(value: object) -> type:
    if type(value) not in _TYPES:
        raise _refused("type")
    return type(value)


def _refused(what: str) -> ValueError:
    return ValueError(f"an expression cannot use '{what:.60}'")


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


def expand(path: Path, arguments: dict[str, str]) -> dict[str, str]:
    """Return the text of a file without macros, or the reason why there is none."""
    import xacro
    from xacro import substitution_args

    refusals: list[str] = []
    packages: list[Path] = []

    def package(name: str) -> str:
        try:
            packages.append(find_package(name, path))
            return str(packages[-1])
        except FileRefusedError as error:
            # xacro raises errors of its own instead
            refusals.append(f"$(find {name[:60]}): {error}")
            raise

    # without ROS, xacro cannot find packages
    substitution_args._eval_find = package
    limit(path, packages, arguments)
    try:
        document = xacro.process_file(str(path), mappings=arguments)
    except RecursionError:
        return {"error": "xacro cannot expand it: a file or a macro contains itself, or it is nested too deeply"}
    except Exception as error:  # the expressions of the file raise anything
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        return {"error": refusals[0] if refusals else f"xacro cannot expand it: {reason:.300}"}
    if not document.getElementsByTagName("link"):
        return {"error": "it defines macros or properties, and no links: load the file that includes it"}
    return {"text": document.toxml()}


class Expansion(Server):
    """Expands files."""

    def answer(self, question: bytes) -> bytes:
        """Expand the file of a question."""
        about = json.loads(question)
        return json.dumps(expand(Path(about["path"]), about["arguments"])).encode()


def main() -> None:
    """Expand the files of the process that has started this one."""
    limit_resources(TIME_LIMIT, MOST_MEMORY)
    serve_program(Expansion, watches=False)


if __name__ == "__main__":
    main()
