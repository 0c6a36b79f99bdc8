"""Sensors that look at the world of a recording: their rays and images were not recorded."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.reports.faults import ENDINGS, describe, name_of
from morse.core.requests import serve
from morse.physics.rays.bundle import RayBundle

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.context import Context

logger = logging.getLogger("morse.viewer")


def look_around(camera: Any) -> None:
    """Capture an image; errors are logged."""
    if camera is None:
        return
    try:
        serve([camera], camera.context.guard)
        camera.action()
    except ENDINGS:
        raise
    except BaseException as error:  # a component of the user may fail
        logger.debug("%s cannot look at the recorded world: %s", name_of(camera), describe(error))


def cast_wished_rays(context: Context, wishes: Collection[str]) -> None:
    """Cast the rays of sensors from their recorded poses, and those with a visible arc."""
    for sensor in context.components.values():
        if sensor.name() in wishes or getattr(sensor, "visible_arc", False):
            for request in sensor.requests:
                if isinstance(request, RayBundle):
                    request.refresh()
