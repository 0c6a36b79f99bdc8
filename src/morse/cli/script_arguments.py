"""Arguments after the scene on the command line of ``morse run``: arguments of the script, or misplaced options."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

from morse.builder.names.project_files import project_files
from morse.cli.messages import warn
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

#: names through which programs access their command line
_READERS = frozenset(
    {"argv", "orig_argv", "argparse", "getopt", "optparse", "absl", "click", "docopt", "fire", "typer", "tyro"}
)


def check_arguments(
    scene: Sequence[str], arguments: Sequence[str], script: Path, source_paths: Iterable[str], parameters: Iterable[Any]
) -> list[str] | None:
    """Return the words of a command line with options of ``morse run`` after the scene in their right order.

    They are options of the script instead, with a warning, if the script may read them itself.

    Args:
        scene: the words that name the scene.
        arguments: the words after the scene.
        script: the file of the scene.
        source_paths: directories of the packages of its project.
        parameters: parameters of ``morse run``.

    Returns:
        None if the order is right, or the options are those of the script.
    """
    takes_value = {name: not parameter.is_flag for parameter in parameters for name in _options_of(parameter)}
    options = [word for word in arguments if word.startswith("-")]
    own = [word for word in options if word.split("=")[0] in takes_value]
    if not options or _reads_arguments(script, [str(script.parent), *source_paths]):
        if own:
            warn(
                f"{', '.join(own)}: arguments after the scene are passed to the script; options of `morse run` have "
                "to be before the scene."
            )
        return None
    if own:
        before, after = _sorted(arguments, takes_value)
        return [*before, *scene, *after]
    warn(f"{', '.join(options)}: the script does not read its arguments, so this has no effect.")
    return None


def _options_of(parameter: Any) -> list[str]:
    return [name for name in (*parameter.opts, *parameter.secondary_opts) if name.startswith("-")]


def _sorted(arguments: Sequence[str], takes_value: dict[str, bool]) -> tuple[list[str], list[str]]:
    """The options of the command with their values, and the other words."""
    before: list[str] = []
    after: list[str] = []
    words = iter(arguments)
    for word in words:
        name, equals, _ = word.partition("=")
        if name not in takes_value:
            after.append(word)
            continue
        before.append(word)
        if takes_value[name] and not equals and (value := next(words, None)) is not None:
            before.append(value)
    return before, after


def _reads_arguments(script: Path, directories: list[str]) -> bool:
    """Whether a script, or a module that it imports from its project, may read the command line."""
    if script.suffix != ".blend":
        try:
            ast.parse(read_regular(script))
        except (OSError, SyntaxError, ValueError):
            return True  # the error is reported when the script is executed
    return any(
        _READERS.intersection(_names(node)) for tree in project_files(script, directories) for node in ast.walk(tree)
    )


def _names(node: ast.AST) -> Iterable[str]:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return (name,)
        case ast.Import(names=names):
            return [alias.name.partition(".")[0] for alias in names]
        case ast.ImportFrom(module=module, names=names):
            return [*(alias.name for alias in names), (module or "").partition(".")[0]]
    return ()
