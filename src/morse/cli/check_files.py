"""``morse check FILE``: what a model or a scene script needs."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table
from rich.text import Text

from morse.assets.summary import class_of, contents
from morse.cli.messages import CommandError, say, sentence
from morse.cli.render import drawn, load, request_of
from morse.cli.scenes import resolve
from morse.core.exceptions import MorseError
from morse.core.reports.printing import console, echo
from morse.system.free_names import free_path
from morse.system.regular_files import check_default_name
from morse.system.source_text import encoded_source

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.builder.survey import Finding, Survey
    from morse.scene import Library, Node
    from morse.simulation.options import RunOptions

    Box = tuple[NDArray[np.float64], NDArray[np.float64]]


# A picture of a model file, in an empty world.

_SIZE, _ANGLE = (960, 720), 40.0
#: direction from the model to the viewpoint: its front, its right side and its top are visible
_FROM = (0.8, -0.5, 0.4)
#: what is larger is the ground of a world, m
_GROUND = 40.0
_SCRIPTS = {
    "Environment": "env = Environment({file!r})",
    "Robot": "robot = Robot({file!r}, sensors=False)\nrobot.translate(z={lift})\nenv = Environment('empty')",
    "PassiveObject": "model = PassiveObject({file!r})\nmodel.translate(z={lift})\nenv = Environment('empty')",
}


def draw(path: Path, library: Library, picture: Path) -> None:
    """Load a model into the physics, and write a picture of it before the first tick.

    Raises:
        CommandError: a scene with the model cannot be loaded.
        OSError: the picture cannot be written.
    """
    import numpy as np

    from morse.mathutils.portable import norm
    from morse.rendering import picture_files

    kind = class_of(library)
    low, high = _box(library)
    # the lowest point of a robot is on the floor
    lift = 0.0 if kind == "Environment" else -float(low[2])
    middle = 0.5 * (low + high) + (0.0, 0.0, lift)
    distance = 0.5 * norm(high - low) / math.sin(math.radians(0.4 * _ANGLE))
    viewpoint = middle + distance / math.hypot(*_FROM) * np.array(_FROM)
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "model.py"
        text = _SCRIPTS[kind].format(file=str(path.absolute()), lift=lift)
        script.write_text(f"from morse.builder import *\n{text}\n", encoding="utf-8")
        simulation = load([str(script)], None)
        try:
            places = tuple(viewpoint.tolist()), tuple(middle.tolist())
            request = request_of(simulation, None, places, _SIZE, _ANGLE, True, True)
            picture_files.save_picture(picture, drawn(request, "color", True))
        finally:
            simulation.close()


def _box(library: Library) -> Box:
    """The corners of what the model shows, without the ground of a world."""
    import numpy as np

    from morse.scene.extent import extent

    boxes = [box for root in library.roots if (box := extent(_shown(root))) is not None]
    boxes = [box for box in boxes if (box[1] - box[0]).max() < _GROUND] or boxes
    if not boxes:
        return np.full(3, -0.5), np.full(3, 0.5)
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def _shown(root: Node) -> list[Node]:
    nodes = [node for node in root.walk() if node.mesh is not None]
    return [node for node in nodes if node.visible] or nodes


# ``morse check robot.sdf``: what MORSE understands of a model file, and how it looks.


def check_model(path: Path, picture: Path | None = None, *, strict: bool = False) -> int:
    """Print a table of the content of a model file, and what is left out.

    Args:
        picture: file for a picture of the model; None for ``<model>_check.png`` in the present folder.
        strict: whether what is left out is an error.

    Returns:
        The exit status.

    Raises:
        CommandError: the file cannot be read, or not be drawn.
    """
    # imported on demand, because it loads numpy
    from morse.assets.formats import reader_of

    try:
        library = reader_of(path)(path)
    except (ValueError, OSError) as error:
        raise CommandError(sentence(error)) from None
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    for name, content in contents(library):
        table.add_row(name, Text(content, overflow="fold"))
    console().print(table)
    target = picture or Path(f"{path.stem}_check.png")
    try:
        if picture is None:
            check_default_name(target)
        draw(path, library, target)
    except OSError as error:
        raise CommandError(f"the picture {target} could not be written: {error.strerror or error}") from None
    say(f"Picture: {target}")
    if strict and library.warnings:
        say(f"{path.name} can be loaded, with {_count(len(library.warnings), 'warning')}.")
        return 1
    say(f"{path.name} can be loaded.")
    return 0


# ``morse check scene.py``: list everything in a scene script that needs a change.


def check_scene(words: Sequence[str], *, fix: bool, strict: bool = False) -> int:
    """Check a scene script, and print what needs a change, with its lines, and whether it runs.

    Args:
        words: as after ``morse run``.
        fix: whether to write a mended copy beside the script.
        strict: whether warnings and old forms are errors, as for ``morse run --strict``.

    Returns:
        The exit status: 1 for an error, as of compilers.

    Raises:
        CommandError: there is no such script.
    """
    resolved = resolve(words)
    options = resolved.options()
    result = _surveyed(options)
    _print(result.findings, resolved.script)
    if fix:
        _fix(result, resolved.script, options)
    say(_verdict(resolved.script.name, result.findings))
    return 1 if result.stops or (strict and result.findings) else 0


def _verdict(name: str, findings: Sequence[Finding]) -> str:
    """The last line: whether the script runs, and what keeps ``morse run --strict`` from running it."""
    if any(finding.stops for finding in findings):
        return f"{name} does not run."
    warnings = sum(not finding.is_old for finding in findings)
    return f"{name} runs, with {_count(warnings, 'warning')}; not with --strict." if warnings else f"{name} runs."


def _surveyed(options: RunOptions, text: str | None = None) -> Survey:
    """The findings of the script, and those of its components when they are loaded without connections."""
    # imported on demand, because they load the builder and the simulator
    from morse.builder.survey import survey
    from morse.launch.load import load
    from morse.middleware.registry import missing_modules

    result = survey(options, text)
    if result.scene is not None and not result.stops:
        try:
            with result.collecting():
                load(result.scene).close()
        except (MorseError, ValueError, OSError) as error:
            result.note_at(getattr(error, "where", None), str(error), stops=True)
        lines = result.scene.lines_of_managers()
        for manager, message in missing_modules(lines).items():
            result.note_at(lines[manager], message, stops=True)
    return result


def _print(findings: Sequence[Finding], script: Path) -> None:
    for finding in findings:
        place = f"{finding.file or script.name}:{finding.line}: " if finding.line else f"{script.name}: "
        kind = "error: " if finding.stops else "" if finding.is_old else "warning: "
        echo(f"{place}{kind}{finding.message}")
    say(f"{_summary(findings)}." if findings else "Nothing needs a change.")


def _summary(findings: Sequence[Finding]) -> str:
    errors, old = sum(finding.stops for finding in findings), sum(finding.is_old for finding in findings)
    numbers = ((errors, "error"), (len(findings) - errors - old, "warning"), (old, "line"))
    words = [_count(number, what) for number, what in numbers if number]
    if old:
        words[-1] += f" with an old form, which still {'works' if old == 1 else 'work'}"
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _fix(result: Survey, script: Path, options: RunOptions) -> None:
    from morse.builder.survey import mended

    text = mended(result.text, result.findings)
    if text == result.text:
        say("Nothing can be fixed automatically: no copy is written.")
        return
    copy = free_path(script.with_name(f"{script.stem}_fixed.py"))
    copy.write_bytes(encoded_source(text))
    rest = _surveyed(options, text)
    say(f"Mended copy: {copy}, which {'does not run' if rest.stops else 'runs'}.")
    if rest.findings:
        say(f"{_count(len(rest.findings), 'line')} of it {'needs' if len(rest.findings) == 1 else 'need'} a person:")
        _print(rest.findings, copy)
