"""The command line of a scene script, as it was under Blender."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from morse.builder.names.project_files import project_files
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

#: under Blender, the arguments of a script follow this word
MARK = "--"


def argv(script: Path, arguments: Sequence[str], directories: Iterable[str]) -> list[str]:
    """``sys.argv`` for a script: its path and its arguments.

    A script of MORSE 1.4 finds its own arguments by ``sys.argv[sys.argv.index('--') + 1:]``. If the script, or a module
    of its project, has the word ``'--'``, it precedes the arguments. Otherwise it is left out: ``argparse`` reads it as
    the end of the options.

    Args:
        script: the file of the scene.
        arguments: the words after the scene on the command line.
        directories: directories of the packages of its project.
    """
    if not _is_written_in(script) and not any(_has_mark(tree) for tree in project_files(script, directories)):
        return [str(script), *arguments]
    return [str(script), MARK, *(arguments[1:] if list(arguments[:1]) == [MARK] else arguments)]


def _is_written_in(script: Path) -> bool:
    """Whether a script that cannot be parsed contains the word."""
    try:
        source = read_regular(script)
        ast.parse(source)
    except OSError:
        return False
    except (SyntaxError, ValueError):
        return any(f"{quote}{MARK}{quote}".encode() in source for quote in "'\"")
    return False


def _has_mark(tree: ast.AST) -> bool:
    return any(isinstance(node, ast.Constant) and node.value == MARK for node in ast.walk(tree))
