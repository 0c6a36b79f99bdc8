"""The names of topics that plugins of Gazebo and ROS set."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import text_of

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_NAME = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


def topic_of(element: Element, usual: str, *tags: str, private: str = "") -> str:
    """Return the topic of a plugin or a sensor.

    A name without a leading slash is below the namespace of the robot.

    Args:
        usual: the name that the plugin has if the file sets none; it may be remapped.
        tags: elements that may contain the name.
        private: the name that ``<remapping>~/out:=scan</remapping>`` replaces.
    """
    name = next((text for tag in tags if (text := text_of(element, tag))), usual)
    ros = element.find("ros")
    for tag in ("remapping", "argument"):
        for remapping in () if ros is None else ros.findall(tag):
            before, _, after = (remapping.text or "").strip().partition(":=")
            if after.strip() and before.strip().removeprefix("~/") in (usual, private, name):
                name = after.strip()
    name = name.removeprefix("~/").replace("::", "/")
    space = (text_of(ros, "namespace") or text_of(element, "robotNamespace")).strip("/")
    if space and not name.startswith("/"):
        name = f"/{space}/{name}"
    return name if _NAME.fullmatch(name) else usual
