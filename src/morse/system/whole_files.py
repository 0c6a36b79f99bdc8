"""Writes files that appear whole or not at all: a full disk or a kill leaves what was there before."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

#: creates a file, and follows no link of its name
_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a file; one of that name is replaced when the new one is complete, and no other file is touched.

    Args:
        content: a text is written as UTF-8, with escapes for what is none.

    Raises:
        OSError: the file cannot be written.
    """
    target = Path(path)
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    copy = target.with_name(f".{secrets.token_hex(12)}.tmp")
    descriptor = os.open(copy, _FLAGS, 0o666)
    try:
        with open(descriptor, "wb") as file:
            file.write(data)
        os.replace(copy, target)
    except BaseException:
        copy.unlink(missing_ok=True)
        raise
