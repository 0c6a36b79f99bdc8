"""Lines of the log about old code."""

from __future__ import annotations

import logging

from morse.builder import workspace
from morse.builder.names import frames

logger = logging.getLogger("morse.builder.script")


def notice(message: str) -> None:
    """Log a warning with the line of the script; in a loop, the same message is logged once."""
    line = str(frames.source_line() or "?")
    said = workspace.current().notices
    if (line, message) not in said:
        said.add((line, message))
        logger.warning("%s: %s", line, message)
