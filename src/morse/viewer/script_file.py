"""The file of a scene script that the editor changes."""

from __future__ import annotations

import codecs
import difflib
import os
import re
import stat
import tempfile
from pathlib import Path

import morse
from morse.builder.editing.changes import Changes, UnwritableError
from morse.builder.editing.writing import changed_script
from morse.system.free_names import free_path
from morse.system.regular_files import read_regular
from morse.system.source_text import encoded_source, quoted, source_text

_PACKAGE = Path(morse.__file__).parent.resolve()
#: of a change by somebody else: lines and columns that an error shows
_SHOWN_LINES = 12
_SHOWN_COLUMNS = 120


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
        belongs = own.suffix == ".py"
        if belongs:
            try:
                # a link into the package belongs to MORSE too
                belongs = not any(
                    path.is_relative_to(_PACKAGE) for path in (own, Path(os.path.realpath(own, strict=True)))
                )
                content = read_regular(own)
                self.text, self._has_mark = source_text(content), content.startswith(codecs.BOM_UTF8)
            except (OSError, SyntaxError) as error:  # it may have changed since it was run
                self._problem = f"{own.name} cannot be read: {error}"
                return
        else:
            self.text = f"from morse.builder import *\n\nenv = Environment({quoted(own.as_posix())})\n"
        self._saved = self.text
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
        return _difference(self._saved, text)

    def save(self, text: str) -> bytes:
        """Replace the file as a whole, or leave it as it is, and return its new content.

        A symbolic link stays, and the file to which it leads is replaced. Mode and owner stay.

        Raises:
            UnwritableError: somebody else has changed it since the scene was loaded, or it cannot be written.
        """
        assert self.path is not None
        try:
            content = (codecs.BOM_UTF8 if self._has_mark else b"") + encoded_source(text)
        except SyntaxError as error:
            raise UnwritableError(f"{self.path.name} cannot be written: {error}") from None
        try:
            if self._content is None:
                self._create(content)
            else:
                self._replace(content)
        except OSError as error:
            folder, reason = os.path.dirname(os.path.realpath(self.path)), error.strerror or type(error).__name__
            raise UnwritableError(f"{self.path.name} in {folder} is not saved, and stays as it was: {reason}") from None
        self._content, self._saved = content, text
        return content

    def _create(self, content: bytes) -> None:
        """Write a file that does not exist."""
        assert self.path is not None
        try:
            descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
        except FileExistsError:
            raise UnwritableError(f"{self.path.name} is not saved: there is such a file now") from None
        try:
            with open(descriptor, "wb") as file:
                file.write(content)
        except OSError:
            self.path.unlink()
            raise

    def _replace(self, content: bytes) -> None:
        """Write the script of the scene."""
        assert self.path is not None
        name = self.path.name
        if not os.path.lexists(self.path):
            raise UnwritableError(f"{name} is not saved: it was deleted or renamed since the scene was loaded")
        target = Path(os.path.realpath(self.path, strict=True))
        before = target.stat()
        if not before.st_mode & 0o222 or not os.access(target, os.W_OK):
            raise UnwritableError(f"{name} is not saved: it is read-only")
        if before.st_nlink > 1:
            raise UnwritableError(
                f"{name} is not saved: the same file has {before.st_nlink} names (hard links), of which only this one "
                "would change; replace it by a copy of it first"
            )
        # a file beside it, so that there is never half a script, also on a full disk
        descriptor, copy = tempfile.mkstemp(dir=target.parent, prefix=".", suffix=".tmp")
        try:
            with open(descriptor, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(descriptor)
            _keep_owner(copy, before)
            os.chmod(copy, stat.S_IMODE(before.st_mode))
            self._check_unchanged(target)
            os.replace(copy, target)
        finally:
            Path(copy).unlink(missing_ok=True)

    def _check_unchanged(self, target: Path) -> None:
        """Raise an error with the difference if the file is not what the scene was loaded from, or was saved."""
        present = read_regular(target)
        if present == self._content:
            return
        try:
            shown = _difference(self._saved, source_text(present)).split("\n")
        except SyntaxError:
            shown = ["it is not text"]
        more = ["..."] if len(shown) > _SHOWN_LINES else []
        raise UnwritableError(
            f"{target.name} was changed since the scene was loaded: reload it first (F11)\n"
            + "\n".join([*(line[:_SHOWN_COLUMNS] for line in shown[:_SHOWN_LINES]), *more])
        )


def _difference(old: str, new: str) -> str:
    # not `splitlines`, for which a form feed ends a line
    old_lines, new_lines = (re.split("\r\n|\r|\n", text) for text in (old, new))
    return "\n".join([*difflib.unified_diff(old_lines, new_lines, lineterm="", n=2)][2:])


def _keep_owner(path: str, before: os.stat_result) -> None:
    """Give a file the owner and the group of another one.

    Raises:
        UnwritableError: only the superuser may.
    """
    present = os.stat(path)
    if (present.st_uid, present.st_gid) == (before.st_uid, before.st_gid) or not hasattr(os, "chown"):
        return
    try:
        os.chown(path, before.st_uid, before.st_gid)
    except PermissionError:
        raise UnwritableError("the script is not saved: it belongs to another user or group") from None
