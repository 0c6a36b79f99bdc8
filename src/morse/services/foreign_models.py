"""The models that clients may spawn: those in the folders of the user, not any file of the disk."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import quoted
from morse.helpers.descriptions import robot_file

if TYPE_CHECKING:
    from collections.abc import Iterable


def check_model(kind: str, folders: Iterable[str | os.PathLike[str]]) -> None:
    """Check that a client may name a model.

    Args:
        kind: name of a robot, name or path of a model, or a robot of such a model: ``Robot('arm.urdf')``.
        folders: folders with models. The folder in which the simulation was started is allowed as well.

    Raises:
        MorseRPCInvokationError: it is a path to another folder.
    """
    kind = robot_file(kind) or kind
    words = kind.split("/")
    if not (os.path.isabs(kind) or ".." in words or kind.startswith("~") or "\\" in kind or ":" in kind):
        return
    # opening a path of another machine would tell its server who the user is
    if os.path.isabs(kind) and not kind.startswith(("//", "\\\\")) and "\0" not in kind:
        directories = [*folders]
        with contextlib.suppress(OSError):  # the folder of the simulation was deleted
            directories.append(Path.cwd())
        real = Path(os.path.realpath(kind))
        if any(real.is_relative_to(os.path.realpath(folder)) for folder in directories):
            return
    raise MorseRPCInvokationError(
        f"clients may spawn robots, and models in the folders of the project and of MORSE_RESOURCE_PATH, not "
        f"{quoted(kind)}; to allow it, add its folder to MORSE_RESOURCE_PATH"
    )
