"""Attributes that do not exist."""

from __future__ import annotations

from typing import NoReturn

from morse.builder.errors import checks


def unknown_attribute(owner: object, name: str) -> NoReturn:
    """Raise the `AttributeError` of an attribute that does not exist, with the nearest one that does."""
    kind = type(owner).__name__
    # classes with slots have no __dict__, and asking for it would lead back here
    own = vars(owner) if type(owner).__dictoffset__ else ()
    public = [n for n in (*dir(type(owner)), *own) if not n.startswith("_")]
    near = checks.closest(name, public)
    hint = f"; did you mean '{near}'?" if near else ""
    raise AttributeError(f"{kind} has no attribute '{name}'{hint}", name=name, obj=owner)
