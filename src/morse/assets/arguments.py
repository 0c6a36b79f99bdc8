"""The arguments of the model file that is being read."""

from __future__ import annotations

from contextvars import ContextVar

ARGUMENTS: ContextVar[dict[str, str]] = ContextVar("arguments")
