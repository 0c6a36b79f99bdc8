"""Lines of source code, which messages about errors quote."""

from __future__ import annotations

import linecache
import os

from morse.system.regular_files import SOURCE_LIMIT, is_regular


def source_line(file: str, line: int, names: dict[str, object] | None = None) -> str:
    """Return a line of a file without the space around it.

    Args:
        file: name of the file, as in a traceback.
        line: its number, from 1.
        names: the globals of its module, whose loader may know the source.

    Returns:
        The line; empty if there is none, or the file is larger than a script may be, a pipe, which would block, or a
        device, which may never end.
    """
    try:
        status = os.stat(file)
        if not is_regular(status) or status.st_size > SOURCE_LIMIT:
            return ""
    except (OSError, ValueError):
        pass  # the loader of the module may know it
    linecache.lazycache(file, names or {})
    linecache.checkcache(file)
    return linecache.getline(file, line, names).strip()
