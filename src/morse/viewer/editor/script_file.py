"""The file of a scene script that the editor changes."""

from __future__ import annotations

import difflib
import os
import tempfile
from pathlib import Path

import morse
from morse.builder.editing.changes import Changes, UnwritableError
from morse.builder.editing.writing import changed_script
from morse.system.free_names import free_path
from morse.system.python_text import quoted

_PACKAGE = Path(morse.__file__).parent


class ScriptFile:
    """The script of a scene; every save writes all changes since the scene was loaded.

    Args:
        script: path of the script or of the model of a world; empty if a program describes the scene.

    Attributes:
        path: the file that is written: the script itself, or a new one in the present folder if the script belongs to
            MORSE or is a model.
        text: the script as it was run.
    """

    def __init__(self, script: str) -> None:
        self.path: Path | None = None
        self.text = ""
        if not script:
            return
        own = Path(script).absolute()
        if own.suffix == ".py":
            with open(own, encoding="utf-8", newline="") as file:
                self.text = file.read()
        else:
            self.text = f"from morse.builder import *\n\nenv = Environment({quoted(own.as_posix())})\n"
        belongs = own.suffix == ".py" and not own.is_relative_to(_PACKAGE)
        stem = own.parent.name if own.stem in ("scene", "default") else own.stem
        self.path = own if belongs else free_path(Path.cwd() / f"{stem}.py")
        self._content = self.text if belongs else None

    def changed(self, changes: Changes) -> str:
        """Return the script with changes.

        Raises:
            UnwritableError: they cannot be written.
        """
        if self.path is None:
            raise UnwritableError("a program describes this scene: there is no script in which it could be saved")
        return changed_script(self.text, changes, self.path.name)

    def difference(self, text: str) -> str:
        """The lines that a save changes, as a unified diff without its head."""
        lines = difflib.unified_diff((self._content or self.text).splitlines(), text.splitlines(), lineterm="", n=2)
        return "\n".join([*lines][2:])

    def save(self, text: str) -> None:
        """Replace the file.

        Raises:
            UnwritableError: somebody else has changed it since the scene was loaded.
            OSError: it cannot be written.
        """
        assert self.path is not None
        present = None
        if self.path.exists():
            with open(self.path, encoding="utf-8", newline="") as file:
                present = file.read()
        if present != self._content:
            raise UnwritableError(f"{self.path.name} was changed since the scene was loaded: reload it first (F11)")
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", newline="", dir=self.path.parent, prefix=".", suffix=".tmp", delete=False
        ) as copy:
            copy.write(text)
        os.chmod(copy.name, 0o644 if present is None else self.path.stat().st_mode)
        os.replace(copy.name, self.path)
        self._content = text
