"""Descriptions of robots as text, in the place of the name of a model."""

from __future__ import annotations

import re


def is_description(kind: str) -> bool:
    """Whether a kind of robot is the text of an XML file, and not a name."""
    return kind.lstrip()[:1] == "<"


#: package, folder and name of a robot or a component that a project defines, e.g. ``ranger_sim.builder.robots:Ranger``
OWN_CLASS = re.compile(r"([A-Za-z_]\w*)\.builder\.(robots|sensors|actuators):([A-Za-z_]\w*)")
