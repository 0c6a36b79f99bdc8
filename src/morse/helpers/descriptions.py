"""Descriptions of robots as text, in the place of the name of a model."""

from __future__ import annotations


def is_description(kind: str) -> bool:
    """Whether a kind of robot is the text of an XML file, and not a name."""
    return kind.lstrip()[:1] == "<"
