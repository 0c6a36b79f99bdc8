"""Warnings of the engine, and the error for unstable physics."""

from __future__ import annotations

import logging

import mujoco

logger = logging.getLogger(__name__)

#: warnings that were logged already, because the engine repeats them in every step
_said: set[str] = set()


def _warn(text: str) -> None:
    kind = text.partition(" at ")[0].partition(". Time")[0]
    if kind not in _said:
        _said.add(kind)
        logger.warning("%s", text)


# without this handler, the engine would write its warnings to a file in the working directory
mujoco.set_mju_user_warning(_warn)


class UnstableError(Exception):
    """The physics diverges even after a reset of the affected bodies; see `morse.physics.rescue`.

    Attributes:
        body: name of the body that diverged first.
    """

    def __init__(self, body: str, what: str) -> None:
        super().__init__(
            f"the physics of '{body}' diverged ({what}), and diverged again after a reset. Look for bodies that "
            "start inside each other, for masses that differ by more than 1:1000, and for forces or speeds that are "
            "far too large"
        )
        self.body = body
