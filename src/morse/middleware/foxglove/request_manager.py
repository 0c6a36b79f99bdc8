"""Offers services to Foxglove."""

from __future__ import annotations

from morse.middleware.foxglove.hub import FoxgloveHub
from morse.middleware.web.requests import WebRequestManager


class FoxgloveRequestManager(WebRequestManager):
    """Services with arguments and results in JSON."""

    classpath = "morse.middleware.foxglove.request_manager.FoxgloveRequestManager"
    hub_class = FoxgloveHub
