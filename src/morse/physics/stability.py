"""Warnings of the engine, and what is raised when it has no answer any more."""

from __future__ import annotations

import logging

import mujoco

logger = logging.getLogger(__name__)

#: what the engine warned of already; it repeats itself every step
_said: set[str] = set()


def _warn(text: str) -> None:
    kind = text.partition(" at ")[0].partition(". Time")[0]
    if kind not in _said:
        _said.add(kind)
        logger.warning("%s", text)


# the engine would write its warnings to a file in the user's directory
mujoco.set_mju_user_warning(_warn)


class UnstableError(Exception):
    """The physics diverges even after a reset of the bodies concerned; see `morse.physics.rescue`.

    Attributes:
        body: name of the body that went first.
    """

    def __init__(self, body: str, what: str) -> None:
        super().__init__(
            f"the physics of '{body}' diverged, {what}, and diverged again after a reset. "
            "Look for bodies that start inside each other, for masses that differ by more than 1:1000, "
            "and for forces or speeds that are far too large"
        )
        self.body = body
