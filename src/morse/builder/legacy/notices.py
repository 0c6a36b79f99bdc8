"""Lines of the log about old code."""

from __future__ import annotations

import logging

from morse.builder import workspace
from morse.builder.names import frames

logger = logging.getLogger("morse.builder.script")


def notice(message: str, old: str = "", new: str = "") -> None:
    """Log a warning with the line of the script; in a loop, the same message is logged once.

    Args:
        message: what is old, and how it is written today.
        old: a word of the line that `morse check --fix` may replace.
        new: its replacement.
    """
    where = frames.source_line()
    notices = workspace.current().notices
    if (where, message) not in notices:
        notices.add((where, message))
        logger.warning("%s", message, extra={"where": where, "is_old": True, "edit": (old, new)})
