"""Which program a recording may have executed: one that the user names, has registered, or explicitly trusts."""

from __future__ import annotations

import ast
import os
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import suffixes
from morse.core.reports.quoting import escaped, shown
from morse.recording.errors import RecordingError
from morse.simulation.recordings.recorders import SCRIPT
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.simulation.options import RunOptions

#: lines of a trusted script that are shown before it is executed, and their length
_SHOWN_LINES, _SHOWN_LENGTH = 12, 120


def use_named(recording: Recording, options: RunOptions, scene: str, projects: Sequence[str]) -> None:
    """Take the script that the user names, with the folders of its project and without the recorded arguments."""
    options.script = scene
    real = Path(os.path.realpath(scene))
    registered = {os.path.realpath(folder) for folder in projects}
    project = next((folder for folder in real.parents if str(folder) in registered), real.parent)
    _take_folders(options, project)


def use_registered(recording: Recording, options: RunOptions, projects: Sequence[str]) -> None:
    """Take the recorded script if it is a scene of a project of the user, without the recorded arguments.

    Raises:
        RecordingError: it is none.
    """
    script = recording.facts.get("script", "")
    _check_name(recording, script)
    why = _refusal(recording, script, projects)
    if why:
        raise RecordingError(
            f"{recording.path} was recorded with the script {shown(script)}, which {why}. A script is a program: "
            "name a script of yours by --scene PATH; to execute what the recording names, use --trust"
        )
    options.script = script
    _take_folders(options, Path(script).parent)


def use_trusted(
    recording: Recording, options: RunOptions, stack: contextlib.ExitStack, say: Callable[[str], object]
) -> None:
    """Take the script, the arguments and the folders that the recording names, and show them.

    Raises:
        RecordingError: there is no script.
    """
    script = recording.facts.get("script", "")
    _check_name(recording, script)
    attachment = recording.attachment(SCRIPT)
    options.script = script
    take_trusted_options(recording, options)
    inside = attachment is not None and not is_same(script, attachment)
    if inside:
        assert attachment is not None
        name = Path(script).name
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        options.script = str(folder / (name if name.endswith(".py") else "scene.py"))
        Path(options.script).write_bytes(attachment)
    elif attachment is None and not Path(script).is_file():
        raise RecordingError(
            f"{recording.path}: the scene {shown(script)} does not exist any more; give a scene: --scene PATH"
        )
    show_trusted(script, options, inside, say)


def take_trusted_options(recording: Recording, options: RunOptions) -> None:
    """Take the arguments and the folders that a trusted recording names."""
    options.arguments = recording.texts("arguments")
    options.source_paths = recording.texts("source_paths")
    options.resource_paths = recording.texts("resource_paths")


def is_same(path: str, content: bytes) -> bool:
    """Whether a file has a content."""
    try:
        return read_regular(path, len(content)) == content
    except (OSError, ValueError):
        return False


def _take_folders(options: RunOptions, project: Path) -> None:
    for name, folders in (("src", options.source_paths), ("data", options.resource_paths)):
        if (project / name).is_dir():
            folders.append(str(project / name))


def _check_name(recording: Recording, script: str) -> None:
    if not script:
        raise RecordingError(
            f"{recording.path}: the scene was created by a function of a program; give a script that creates it: "
            "--scene PATH"
        )


def _refusal(recording: Recording, script: str, projects: Sequence[str]) -> str:
    """Why a script is not a scene of a registered project; empty if it is one.

    Only texts are compared until the folder is one of the user: a path in the file may lead anywhere by ``..``, links,
    ``/proc`` or a server, which would be told who the user is.
    """
    folder, name = os.path.split(script)
    registered = {place for project in projects for place in (str(project), os.path.realpath(project))}
    if folder not in registered or os.path.join(folder, name) != script:
        return "is not in the folder of an environment that you have registered (morse import)"
    if os.path.realpath(folder) == os.path.realpath(os.path.dirname(os.path.abspath(recording.path))):
        return "is in the folder of the recording, and may have come with it"
    try:
        # on a file system that ignores case, another spelling would open the file
        is_there = name in os.listdir(folder) and stat.S_ISREG(os.lstat(script).st_mode)
    except (OSError, ValueError):
        is_there = False
    if not is_there:
        return "does not exist as a file there any more"
    if Path(name).suffix.lower() in suffixes():  # a model is no program
        return ""
    attachment = recording.attachment(SCRIPT)
    if attachment is None:
        return "the recording does not contain, so that they cannot be compared"
    if not is_same(script, attachment):
        return "has changed since the run was recorded"
    return (
        ""
        if name.endswith(".py") and _is_scene(attachment)
        else "does not import morse.builder, so that it is not a scene"
    )


def _is_scene(source: bytes) -> bool:
    """Whether a program imports the builder: other programs of a project may be meant for other purposes."""
    try:
        tree = ast.parse(source)
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        return False
    modules: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            modules += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return any(module == "morse.builder" or module.startswith("morse.builder.") for module in modules)


def show_trusted(script: str, options: RunOptions, inside: bool, say: Callable[[str], object]) -> None:
    """Show the script, the arguments and the folders that are about to be used.

    Args:
        script: path of the script in the recording.
        inside: whether the script is that inside the recording.
    """
    arguments = f"with the arguments {shown(options.arguments, 1000)}" if options.arguments else "without arguments"
    if inside:
        say(f"{escaped(script)} is missing or has changed since the run was recorded: the recorded script is used.")
    what = f"the script inside the recording ({options.script})" if inside else escaped(options.script)
    for folder in options.source_paths:
        say(f"--trust: modules are imported from {shown(folder)}.")
    say(f"--trust: executes {what} {arguments}. It begins with:")
    for line in _beginning(options.script):
        say(f"  | {line}")


def _beginning(script: str) -> list[str]:
    if Path(script).suffix.lower() in suffixes():
        return ["a model, which is not a program"]
    try:
        lines = read_regular(script).decode("utf-8", "replace").splitlines()
    except OSError as error:
        return [f"it cannot be read: {error.strerror or error}"]
    rest = len(lines) - _SHOWN_LINES
    return [escaped(line[:_SHOWN_LENGTH]) for line in lines[:_SHOWN_LINES]] + [f"... {rest} more lines"] * (rest > 0)
