"""Offers services to clients of rosbridge."""

from __future__ import annotations

from morse.middleware.rosbridge.hub import RosbridgeHub
from morse.middleware.web.requests import WebRequestManager


class RosbridgeRequestManager(WebRequestManager):
    """Services for the operation ``call_service``."""

    classpath = "morse.middleware.rosbridge.request_manager.RosbridgeRequestManager"
    hub_class = RosbridgeHub
