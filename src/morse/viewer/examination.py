"""The program that reads the models that a page has sent: ``python -m morse.viewer.examination``.

A file of anybody may take seconds, much memory, or end the process that reads it. The simulation goes on meanwhile, on
another processor, and gets what was found: what is said about each file, the models that can be added, and the contents
of their files, which it does not read again.
"""

from __future__ import annotations

import json
import os
import pickle
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from morse.assets import load
from morse.assets.collision import prepare_moving
from morse.assets.formats import is_model, of_strangers
from morse.assets.loader import Content, content_of
from morse.assets.summary import class_of, contents
from morse.core.reports.faults import message
from morse.core.reports.quoting import short
from morse.helpers.descriptions import robot_kind
from morse.system.workers import Server, limit_resources, serve_program
from morse.viewer.view_messages import Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Library

#: of an examination: processor time, s, wall-clock time, s, memory, bytes
MOST_SECONDS, PATIENCE, MOST_MEMORY = 120.0, 300.0, 4 << 30
#: triangles of a model that is added to a running simulation, which waits for it; about 10 µs each, since their
#: collision shapes were computed by the examination
_MOST_TRIANGLES = 300_000
#: files that describe a whole robot or world, then those of scenes; others are parts of them, if there are any
_WHOLES = ((".urdf", ".sdf", ".world", ".xml", ".mjcf"), (".blend", ".glb", ".gltf"))
#: files of an upload that are examined, objects of a file that are offered, lines about a file
_MOST_MODELS, _MOST_OBJECTS, _MOST_LINES = 20, 200, 60


class Examined(NamedTuple):
    """What was found in the files of an upload.

    Attributes:
        report: what is to be said about each model.
        models: those that can be added.
        contents: of their files.
    """

    report: list[dict[str, object]]
    models: list[Model]
    contents: list[Content]


def read_answer(answer: bytes) -> Examined:
    """What the program has answered, which is a process of ours: nobody else writes to its pipe."""
    return Examined(*pickle.loads(answer))


def examine(folder: Path, files: Sequence[PurePosixPath]) -> Examined:
    """Read the models among some files of a folder."""
    examined = Examined([], [], [])
    paths = _wholes(folder, files)
    if not paths:
        examined.report.append(entry(folder.name, "there is no model among the files"))
    for path in paths[:_MOST_MODELS]:
        try:
            with of_strangers():
                library = load(folder / path)
            found, why = _models(f"{folder.name}/{path.as_posix()}", library)
            if found and class_of(library) != "Robot":
                prepare_moving(library.nodes())
            lines = [[title, short(text, 400)] for title, text in contents(library)][:_MOST_LINES]
        except Exception as error:  # a reader of a package may raise anything
            text = message(error).replace(f"{folder}{os.sep}", "").replace(str(folder), folder.name)
            examined.report.append(entry(path.as_posix(), short(text, 500)))
            continue
        examined.report.append(entry(path.as_posix(), why, lines, found))
        if found:
            examined.models.extend(found)
            examined.contents.append(content_of(folder / path))
    return examined


def entry(file: str, error: str, lines: Sequence[list[str]] = (), models: Sequence[Model] = ()) -> dict[str, object]:
    """What is said about a model: why it cannot be added, or what it has."""
    return {"file": file, "error": error, "contents": [*lines], "kinds": [[one.kind, one.name] for one in models]}


def _wholes(folder: Path, paths: Sequence[PurePosixPath]) -> list[PurePosixPath]:
    """The files that are not parts of others, those in the fewest folders first."""
    found = sorted((path for path in paths if is_model(Path(path))), key=lambda path: (len(path.parts), path))
    # package.xml of ROS, and others
    found = [path for path in found if path.suffix.lower() != ".xml" or b"<mujoco" in (folder / path).read_bytes()]
    for endings in _WHOLES:
        if wholes := [path for path in found if path.suffix.lower() in endings]:
            return wholes
    return found


def _models(file: str, library: Library) -> tuple[list[Model], str]:
    """The models of a file that can be added, and why there are none."""
    name = PurePosixPath(file).stem
    if library.world:
        return [], f"it is a world, which a scene has one of: write Environment({file!r}) into the script"
    if not library.roots:
        return [], "there is nothing in it"
    triangles = sum(len(node.mesh.triangles) for node in library.nodes() if node.mesh is not None)
    if triangles > _MOST_TRIANGLES:
        return [], (
            f"it has {triangles:,} triangles, of which a running simulation takes at most {_MOST_TRIANGLES:,}: make it "
            f"simpler, or write PassiveObject({file!r}) into the script"
        )
    if class_of(library) == "Robot":
        return [Model(robot_kind(file), name, "robots", "a robot of your own files")], ""
    group = f"{name}, of your own files"
    if len(library.roots) == 1:
        return [Model(file, name, group)], ""
    return [Model(f"{file}#{root.name}", root.name, group) for root in library.roots[:_MOST_OBJECTS]], ""


class Examination(Server):
    """Examines the files of a folder."""

    def answer(self, question: bytes) -> bytes:
        """Examine the files of a question: a folder, and paths below it."""
        folder, files = json.loads(question)
        return pickle.dumps((*examine(Path(folder), [*map(PurePosixPath, files)]),), protocol=5)


if __name__ == "__main__":
    limit_resources(MOST_SECONDS, MOST_MEMORY)
    serve_program(Examination)
