"""The class of messages on ``/tf``, under the module name of MORSE 1.4."""

from __future__ import annotations

from importlib import import_module

tfMessage: object = import_module("tf2_msgs.msg").TFMessage

__all__ = ["tfMessage"]
