"""The participant of a ROS domain, shared by the streams and the services of a simulation."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from morse.core.exceptions import MorseMiddlewareError
from morse.core.validation.options import checked_options, with_defaults
from morse.middleware.ros2 import LAST_DOMAIN, MANAGER_OPTIONS, MIDDLEWARE
from morse.middleware.ros2.backends.choice import make_backend

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import Options, RosMessage
    from morse.rosmsgs.topics.backend import Backend

_joined: WeakKeyDictionary[Context, Backend] = WeakKeyDictionary()


def options_of(context: Context) -> RosMessage:
    """The options of ``env.configure_stream_manager('ros2', ...)`` with defaults.

    Raises:
        OptionError: an option does not exist, or has an invalid value.
    """
    options = context.scene.manager_options.get(MIDDLEWARE.stream_manager or "", {})
    return with_defaults(MANAGER_OPTIONS, checked_options("ros2", MANAGER_OPTIONS, dict(options)))


def join(context: Context, options: Options) -> Backend:
    """Return the participant of a simulation; the caller has to call `Backend.release` at the end.

    Raises:
        MorseMiddlewareError: no backend is installed, or it cannot join.
    """
    membership = _joined.get(context)
    if membership is not None and membership.users:
        membership.users += 1
        return membership
    backend = make_backend({**options, "domain_id": _domain(options)})
    backend.users = 1
    _joined[context] = backend
    return backend


def _domain(options: Options) -> int:
    if options["domain_id"] is not None:
        return int(options["domain_id"])
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        raise MorseMiddlewareError(f"ros2: ROS_DOMAIN_ID is {text!r}, expected a number from 0 to {LAST_DOMAIN}")
    return int(text)
