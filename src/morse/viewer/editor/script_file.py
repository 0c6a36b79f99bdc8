"""The file of a scene script that the editor changes."""

from __future__ import annotations

import codecs
import difflib
import os
import tempfile
from pathlib import Path

import morse
from morse.builder.editing.changes import Changes, UnwritableError
from morse.builder.editing.writing import changed_script
from morse.system.free_names import free_path
from morse.system.python_text import quoted
from morse.system.regular_files import read_regular
from morse.system.source_text import encoded_source, source_text

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
        self._problem = "a program describes this scene: there is no script in which it could be saved"
        self._has_mark = False
        self._content: bytes | None = None
        if not script:
            return
        own = Path(script).absolute()
        content = b""
        if own.suffix == ".py":
            try:
                content = read_regular(own)
                self.text, self._has_mark = source_text(content), content.startswith(codecs.BOM_UTF8)
            except (OSError, SyntaxError) as error:  # it may have changed since it was run
                self._problem = f"{own.name} cannot be read: {error}"
                return
        else:
            self.text = f"from morse.builder import *\n\nenv = Environment({quoted(own.as_posix())})\n"
        self._saved = self.text
        belongs = own.suffix == ".py" and not own.is_relative_to(_PACKAGE)
        stem = own.parent.name if own.stem in ("scene", "default") else own.stem
        self.path = own if belongs else free_path(Path.cwd() / f"{stem}.py")
        self._content = content if belongs else None

    def changed(self, changes: Changes) -> str:
        """Return the script with changes.

        Raises:
            UnwritableError: they cannot be written.
        """
        if self.path is None:
            raise UnwritableError(self._problem)
        return changed_script(self.text, changes, self.path.name)

    def difference(self, text: str) -> str:
        """The lines that a save changes, as a unified diff without its head."""
        lines = difflib.unified_diff(self._saved.splitlines(), text.splitlines(), lineterm="", n=2)
        return "\n".join([*lines][2:])

    def save(self, text: str) -> None:
        """Replace the file.

        Raises:
            UnwritableError: somebody else has changed it since the scene was loaded.
            OSError: it cannot be written.
        """
        assert self.path is not None
        try:
            content = (codecs.BOM_UTF8 if self._has_mark else b"") + encoded_source(text)
        except SyntaxError as error:
            raise UnwritableError(f"{self.path.name} cannot be written: {error}") from None
        present = read_regular(self.path) if self.path.exists() else None
        if present != self._content:
            raise UnwritableError(f"{self.path.name} was changed since the scene was loaded: reload it first (F11)")
        with tempfile.NamedTemporaryFile(dir=self.path.parent, prefix=".", suffix=".tmp", delete=False) as copy:
            copy.write(content)
        os.chmod(copy.name, 0o644 if present is None else self.path.stat().st_mode)
        os.replace(copy.name, self.path)
        self._content, self._saved = content, text
