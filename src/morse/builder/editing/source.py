"""The text of a scene script, the places of its statements, and changes that are proved before they count."""

from __future__ import annotations

import ast
import builtins
import io
import keyword
import re
import tokenize
from bisect import bisect_left, bisect_right
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from morse.builder.editing.changes import UnwritableError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

BUILDER = "morse.builder"
#: fields of syntax nodes that contain names
_NAME_FIELDS = ("id", "attr", "name", "asname", "arg", "names", "rest", "kwd_attrs")


class Place(NamedTuple):
    """Where a statement stands: the list of statements that contains it, and its number there."""

    block: list[ast.stmt]
    at: int


class _Insertion(NamedTuple):
    """New statements beside one of the script; those of low rank stand first."""

    rank: int
    statements: list[ast.stmt]


class Source:
    """A script and the changes that are to be made in it.

    Each change is noted twice: as a replacement of text, and as a change of the syntax tree. `text` makes the
    replacements, and refuses the result unless it reads as the changed tree and has all comments.

    All places are counted in bytes, as `ast` counts columns.

    Attributes:
        tree: the script.
        block: the statements among which ``Environment(...)`` stands: the innermost list that contains all calls.
        environment: the first of them that contains such a call.

    Raises:
        UnwritableError: it is not valid Python, or does not create an environment.
    """

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        try:
            self.tree = ast.parse(text)
            self._tokens = _tokens(text)
        except SyntaxError as error:
            raise UnwritableError(f"{name}, line {error.lineno}, is not valid Python: {error.msg}") from None
        except (ValueError, RecursionError, MemoryError, tokenize.TokenError) as error:
            raise UnwritableError(f"{name} is not valid Python: {error}") from None
        self._data = text.encode()
        self._lines = self._data.splitlines(keepends=True)
        self._starts = [0]
        for line in self._lines:
            self._starts.append(self._starts[-1] + len(line))
        end = re.search("\r\n|\r|\n", text)
        self._newline = "\n" if end is None else end.group()
        #: rows that end a logical line
        self._ends = [token.start[0] for token in self._tokens if token.type == tokenize.NEWLINE]
        self._places = {
            id(statement): Place(block, at) for block in _all_blocks(self.tree) for at, statement in enumerate(block)
        }
        self._replacements: list[tuple[int, int, int, str]] = []
        self._removed: set[int] = set()
        self._changed: dict[int, ast.AST] = {}
        self._before: dict[int, list[_Insertion]] = {}
        self._after: dict[int, list[_Insertion]] = {}
        self._imports: dict[str, set[str]] = {}
        calls = _paths_to_environments(self)
        if not calls:
            raise UnwritableError(f"{name} does not contain Environment(...), before which new objects are written")
        self.top = calls[0][0]
        self.block, first = calls[0][_common_depth(calls)]
        self.environment = self.block[first]
        self.quote = "'" if text.count("'") > text.count('"') else '"'

    # -- what the script contains ----------------------------------------------------------

    def names(self) -> set[str]:
        """Every name and every word that the script uses, and the names that have a meaning in Python."""
        used: set[str] = set()
        for node in ast.walk(self.tree):
            values = [getattr(node, field, None) for field in _NAME_FIELDS]
            values += [node.value] if isinstance(node, ast.Constant) else []
            for value in values:
                used.update(one for one in (value if isinstance(value, list) else [value]) if isinstance(one, str))
        return used | set(dir(builtins)) | {*keyword.kwlist, *keyword.softkwlist}

    def place(self, statement: ast.stmt) -> Place:
        """Where a statement of the script stands."""
        return self._places[id(statement)]

    def span(self, node: ast.stmt | ast.expr | ast.alias) -> tuple[int, int]:
        """Begin and end; a function or a class begins with its decorators."""
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        begin = self._starts[node.lineno - 1] + node.col_offset
        if decorators := getattr(node, "decorator_list", None):
            begin = self._data.rindex(b"@", 0, self.span(decorators[0])[0])
        return begin, self._starts[node.end_lineno - 1] + node.end_col_offset

    def is_elif(self, node: ast.AST, block: list[ast.stmt]) -> bool:
        """Whether a block of a node is an ``elif``, which has no statements beside it."""
        if not isinstance(node, ast.If) or block is not node.orelse or not isinstance(block[0], ast.If):
            return False
        return self._data.startswith(b"elif", self.span(block[0])[0])

    def end_of_arguments(self, call: ast.Call, last: ast.expr | None) -> int:
        """Where another argument of a call is written: behind the last one and the brackets around it."""
        if last is None:
            return self.span(call)[1] - 1
        (_, begin), (_, end) = self.span(last), self.span(call)
        gap = bytearray(self._data[begin:end])
        for first, behind, _ in self._comments():
            if begin <= first < end:
                gap[first - begin : behind - begin] = b" " * (behind - first)
        own = gap.partition(b",")[0] if b"," in gap else gap[: gap.rindex(b")")]
        return begin + own.rfind(b")") + 1

    def _comments(self) -> Iterator[tuple[int, int, str]]:
        for token in self._tokens:
            if token.type == tokenize.COMMENT:
                row, column = token.start
                begin = self._starts[row - 1] + len(self._lines[row - 1].decode()[:column].encode())
                yield begin, begin + len(token.string.encode()), token.string

    def _row(self, offset: int) -> int:
        """The line of a place, from 1."""
        return bisect_right(self._starts, offset, hi=len(self._lines))

    def _logical(self, offset: int) -> int:
        """The number of the logical line of a place: statements share one if semicolons join them."""
        return bisect_left(self._ends, self._row(offset))

    def _is_inline(self, block: list[ast.stmt]) -> bool:
        """Whether a block stands behind its colon."""
        begin, _ = self.span(block[0])
        return bool(self._data[self._starts[self._row(begin) - 1] : begin].strip())

    def _begins_line(self, statement: ast.stmt) -> bool:
        block, index = self.place(statement)
        if index == 0:
            return not self._is_inline(block)
        return self._logical(self.span(block[index - 1])[1]) != self._logical(self.span(statement)[0])

    def _ends_line(self, statement: ast.stmt) -> bool:
        block, index = self.place(statement)
        if self._is_inline(block):
            return False
        if index + 1 == len(block):
            return True
        return self._logical(self.span(statement)[1]) != self._logical(self.span(block[index + 1])[0])

    def _indent(self, block: list[ast.stmt]) -> str:
        begin, _ = self.span(block[0])
        return self._data[self._starts[self._row(begin) - 1] : begin].decode().rpartition("\f")[2]

    # -- changes ---------------------------------------------------------------------------

    def edit(self, begin: int, end: int, text: str) -> None:
        """Note a replacement of text within an expression; see `change`."""
        self._replacements.append((begin, end, 0, text))

    def change(self, old: ast.expr | ast.stmt, new: ast.expr | ast.stmt) -> None:
        """Note what a node of the tree becomes by edits of its text."""
        self._changed[id(old)] = new

    def insert_after(self, statement: ast.stmt, lines: list[str], rank: int = 1) -> None:
        """Note new statements, each of them one line, after a statement."""
        self._after.setdefault(id(statement), []).append(_Insertion(rank, ast.parse("\n".join(lines)).body))
        _, end = self.span(statement)
        if not self._ends_line(statement):
            self._replacements.append((end, end, rank, "".join(f"; {line}" for line in lines)))
            return
        indent = self._indent(self.place(statement).block)
        place = self._starts[self._ends[self._logical(end)]]
        if place == len(self._data) and not self._data.endswith((b"\n", b"\r")):  # the last line of the file
            text = "".join(f"{self._newline}{indent}{line}" for line in lines)
        else:
            text = "".join(f"{indent}{line}{self._newline}" for line in lines)
        self._replacements.append((place, place, rank, text))

    def insert_before(self, statement: ast.stmt, paragraphs: list[list[str]], rank: int = 2) -> None:
        """Note new statements before a statement, and before the comments that belong to it."""
        lines = [line for paragraph in paragraphs for line in paragraph]
        self._before.setdefault(id(statement), []).append(_Insertion(rank, ast.parse("\n".join(lines)).body))
        begin, _ = self.span(statement)
        if not self._begins_line(statement):
            self._replacements.append((begin, begin, rank, "".join(f"{line}; " for line in lines)))
            return
        row = self._row(begin) - 1
        above = self._ends[self._logical(begin) - 1] if self._logical(begin) else 0
        # comments above an import may name the encoding and the interpreter
        while rank and row > above and self._lines[row - 1].lstrip().startswith(b"#"):
            row -= 1
        lines = [line for number, paragraph in enumerate(paragraphs) for line in ([""] * (number > 0) + paragraph)]
        if row > 0 and self._lines[row - 1].strip():
            lines.insert(0, "")
        indent = self._indent(self.place(statement).block)
        text = "".join(f"{indent}{line}{self._newline}" if line else self._newline for line in [*lines, ""])
        self._replacements.append((self._starts[row], self._starts[row], rank, text))

    def remove(self, statements: Iterable[ast.stmt]) -> None:
        """Note that statements are removed; a comment behind the last one of a line goes with it."""
        self._removed.update(map(id, statements))

    def _removals(self) -> list[tuple[int, int, int, str]]:
        """The replacements that remove statements: those of one logical line together."""
        found = []
        for block in _all_blocks(self.tree):
            first = 0
            for last, statement in enumerate(block, 1):
                if id(statement) not in self._removed:
                    first = last
                elif last == len(block) or self._ends_line(statement) or id(block[last]) not in self._removed:
                    found.append((*self._span_of(block, first, last), 0, ""))
                    first = last
        return found

    def _span_of(self, block: list[ast.stmt], first: int, last: int) -> tuple[int, int]:
        """Begin and end of statements of one logical line, with the semicolon or the lines that go with them."""
        (begin, _), (_, end) = self.span(block[first]), self.span(block[last - 1])
        if self._ends_line(block[last - 1]):
            if self._begins_line(block[first]):
                return self._starts[self._row(begin) - 1], self._starts[self._ends[self._logical(end)]]
            # the statements before them on the line stay, and so does what ends it
            return self.span(block[first - 1])[1], end
        if last < len(block):
            return begin, self.span(block[last])[0]
        return self.span(block[first - 1])[1], end

    def need(self, names: set[str], module: str = BUILDER) -> None:
        """Note names that new statements use: those that the script does not have are imported.

        Raises:
            UnwritableError: the script gives a name another meaning.
        """
        for node in ast.walk(self.tree):
            for name in names & {*_bound(node, module)}:
                line = getattr(node, "lineno", 1)
                raise UnwritableError(
                    f"{self.name}, line {line}, gives '{name}' another meaning than {module}: rename it there"
                )
        for other, others in self._imports.items():
            if other != module and (both := names & others):
                raise UnwritableError(f"'{min(both)}' comes from {other} and from {module}: write one of them by hand")
        self._imports.setdefault(module, set()).update(names)

    def _import(self) -> None:
        """Note the imports of names that are needed."""
        before = [
            node
            for node in self.tree.body[: self.top.at]
            if isinstance(node, (ast.Import, ast.ImportFrom)) and id(node) not in self._removed
        ]
        for module, names in sorted(self._imports.items()):
            present: set[str] = set()
            last: ast.ImportFrom | None = None
            for node in before:
                if not isinstance(node, ast.ImportFrom):
                    continue
                words = {alias.name for alias in node.names}
                if node.module == module and not node.level:
                    present |= {alias.name for alias in node.names if alias.asname in (None, alias.name)}
                    last = node
                elif "*" in words:  # it may replace them
                    present, last = set(), None
            missing = sorted(names - present)
            if "*" in present or not missing:
                continue
            if last is not None:
                _, end = self.span(last.names[-1])
                self.edit(end, end, "".join(f", {name}" for name in missing))
                aliases = [*last.names, *(ast.alias(name=name) for name in missing)]
                self.change(last, ast.ImportFrom(module=module, names=aliases, level=0))
                continue
            line = f"from {module} import {', '.join(missing)}"
            docstring = self.tree.body[0] if ast.get_docstring(self.tree, clean=False) is not None else None
            if anchor := before[-1] if before else docstring:
                self.insert_after(anchor, [line], rank=0)
            else:
                self.insert_before(self.tree.body[0], [[line]], rank=0)

    # -- the result ------------------------------------------------------------------------

    def text(self) -> str:
        """The script with all changes.

        Raises:
            UnwritableError: the result would differ in more than the changes.
        """
        self._import()
        removals = self._removals()
        data, ordered = self._data, sorted([*self._replacements, *removals], key=lambda one: one[:3])
        overlap = any(begin < end for (_, end, _, _), (begin, *_) in pairwise(ordered))
        for begin, end, _, text in reversed(ordered):
            data = data[:begin] + text.encode() + data[end:]
        result = data.decode()
        if overlap or not self._is_proved(result, [(begin, end) for begin, end, _, _ in removals]):
            raise UnwritableError(
                f"{self.name} cannot be changed without changing other statements or comments too: edit it by hand"
            )
        return result

    def _is_proved(self, text: str, removed: list[tuple[int, int]]) -> bool:
        """Whether a text reads as the changed tree, and has all comments outside of what is removed."""
        kept = [
            comment for first, _, comment in self._comments() if not any(begin <= first < end for begin, end in removed)
        ]
        try:
            same = ast.dump(ast.parse(text)) == ast.dump(self._expected(self.tree))
            comments = [token.string for token in _tokens(text) if token.type == tokenize.COMMENT]
        except (SyntaxError, ValueError, RecursionError, MemoryError, tokenize.TokenError):
            return False
        return same and comments == kept

    def _expected(self, node: ast.AST) -> ast.AST:
        """The changed tree."""
        if id(node) in self._changed:
            return self._changed[id(node)]
        fields = {name: self._expected_field(value) for name, value in ast.iter_fields(node)}
        return type(node)(**fields)

    def _expected_field(self, value: object) -> object:
        if isinstance(value, ast.AST):
            return self._expected(value)
        if not isinstance(value, list):
            return value
        items: list[object] = []
        for item in value:
            for insertion in sorted(self._before.get(id(item), ()), key=lambda one: one.rank):
                items += insertion.statements
            if id(item) not in self._removed:
                items.append(self._expected_field(item))
            for insertion in sorted(self._after.get(id(item), ()), key=lambda one: one.rank):
                items += insertion.statements
        return items


def name_of(node: ast.AST) -> str:
    """The dotted name of an expression; empty if it is none."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and (owner := name_of(node.value)):
        return f"{owner}.{node.attr}"
    return ""


def bound_names(node: ast.AST) -> Iterator[str]:
    """The names to which a node of a syntax tree, without those below it, gives a value."""
    if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
        yield node.id
    elif isinstance(node, ast.alias):
        yield node.asname or node.name.partition(".")[0]
    elif isinstance(node, ast.arg):
        yield node.arg
    elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.ExceptHandler, ast.MatchAs)):
        if node.name is not None:
            yield node.name
    elif isinstance(node, ast.MatchStar) and node.name is not None:
        yield node.name
    elif isinstance(node, ast.MatchMapping) and node.rest is not None:
        yield node.rest


def _bound(node: ast.AST, module: str) -> Iterator[str]:
    """The names to which a node gives a value that is not that of a module."""
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        if not isinstance(node, ast.ImportFrom) or node.module != module or node.level:
            for alias in node.names:
                if not isinstance(node, ast.Import) or alias.name != f"{module}.{alias.asname}":
                    yield from bound_names(alias)
        else:
            yield from (alias.asname for alias in node.names if alias.asname not in (None, alias.name))
    elif not isinstance(node, ast.alias):
        yield from bound_names(node)


def _tokens(text: str) -> list[tokenize.TokenInfo]:
    """The tokens of a script; lines and columns are those of `ast`."""
    # `tokenize` does not know the end of line "\r"
    text = re.sub("\r\n?", "\n", text)
    return list(tokenize.generate_tokens(io.StringIO(text).readline))


def _all_blocks(node: ast.AST) -> Iterator[list[ast.stmt]]:
    for one in ast.walk(node):
        for _, value in ast.iter_fields(one):
            if isinstance(value, list) and value and isinstance(value[0], ast.stmt):
                yield value


def _paths_to_environments(source: Source) -> list[list[Place]]:
    """For each call that creates an environment: the statements that contain it, the outermost first."""
    tree = source.tree
    names = {"Environment"}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module == BUILDER:
            names |= {one.asname for one in node.names if one.name == "Environment" and one.asname}
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef) and any(name_of(base).rpartition(".")[2] in names for base in node.bases):
            names.add(node.name)
    paths: list[list[Place]] = []

    def search(node: ast.AST, path: list[Place]) -> None:
        if isinstance(node, ast.Call) and name_of(node.func).rpartition(".")[2] in names:
            paths.append(path)
        for _, value in ast.iter_fields(node):
            if isinstance(value, ast.AST):
                search(value, path)
            elif isinstance(value, list):
                is_block = bool(value) and isinstance(value[0], ast.stmt) and not source.is_elif(node, value)
                for index, item in enumerate(value):
                    if isinstance(item, ast.AST):
                        search(item, [*path, Place(value, index)] if is_block else path)

    try:
        search(tree, [])
    except RecursionError:
        raise UnwritableError(f"{source.name} is nested too deeply to be edited") from None
    return paths


def _common_depth(paths: list[list[Place]]) -> int:
    """The depth of the innermost list of statements in which all paths begin."""
    depth = 0
    while all(len(path) > depth + 1 for path in paths):
        first = paths[0]
        if any(path[depth] != first[depth] or path[depth + 1].block is not first[depth + 1].block for path in paths):
            break
        depth += 1
    return depth
