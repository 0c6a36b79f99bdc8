"""Checks of installed packages and of the project: what they find are warnings about the scene.

A package names a function, which gets the scene and returns `morse.scene.SceneWarning` objects, by an entry point::

    [project.entry-points."morse.checks"]
    masses = "my_lab.checks:heavy_props"
"""

from __future__ import annotations

import logging
from itertools import islice
from typing import TYPE_CHECKING

from morse.core.classes.plugins import entry_points
from morse.core.reports.faults import ENDINGS, describe
from morse.scene.scene_warnings import SceneWarning

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Scene

logger = logging.getLogger(__name__)

#: maximum number of warnings of one check; the log is to be read
_MOST = 100


def log_warnings_of_packages(scene: Scene) -> None:
    """Log what the checks of packages find in a complete scene; a check that fails is named, and the others go on."""
    with scene.project:
        for point in entry_points("morse.checks"):
            try:
                _log(point.load()(scene))
            except ENDINGS:
                raise
            except BaseException as error:  # the package is third-party code
                logger.warning("the check '%s' (%s) cannot be made: %s", point.name, point.value, describe(error))


def _log(warnings: Iterable[object]) -> None:
    for warning in islice(warnings, _MOST):
        if not isinstance(warning, SceneWarning):
            raise TypeError(f"it returns {warning!r:.80}, expected objects of morse.scene.SceneWarning")
        logger.warning("%s", warning.message, extra={"where": warning.where, "is_old": warning.is_old})
