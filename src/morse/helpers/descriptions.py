"""Descriptions of robots as text, in the place of the name of a model."""

from __future__ import annotations

import re


def is_description(kind: str) -> bool:
    """Whether a kind of robot is the text of an XML file, and not a name."""
    return kind.lstrip()[:1] == "<"


#: a robot from a file: ``Robot('arm/arm.urdf')``; the name of a file without more is an object
_OF_FILE = re.compile(r"Robot\('([^'\"\\\n\r]+)'\)")


def robot_kind(file: str) -> str:
    """The kind of a robot that a model file describes, as it stands in a scene script."""
    return f"Robot('{file}')"


def robot_file(kind: str) -> str | None:
    """The model file of a kind of `robot_kind`; None for any other kind."""
    found = _OF_FILE.fullmatch(kind)
    return None if found is None else found[1]


#: package, folder and name of a robot or a component that a project defines, e.g. ``ranger_sim.builder.robots:Ranger``
OWN_CLASS = re.compile(r"([A-Za-z_]\w*)\.builder\.(robots|sensors|actuators):([A-Za-z_]\w*)")
