"""Attributes that do not exist."""

from __future__ import annotations

from typing import NoReturn

from morse.builder.errors import checks


def unknown_attribute(owner: object, name: str) -> NoReturn:
    """Raise the `AttributeError` for an attribute that does not exist; the message names the nearest one."""
    kind = type(owner).__name__
    # classes with slots have no __dict__, and access to it would call this function again
    own = vars(owner) if type(owner).__dictoffset__ else ()
    public = [n for n in (*dir(type(owner)), *own) if not n.startswith("_")]
    near = checks.closest(name, public)
    hint = f"; did you mean '{near}'?" if near else ""
    # with a name, but without an object, Python adds no suggestion of its own
    raise AttributeError(f"{kind} has no attribute '{name}'{hint}", name=name)
