"""The two models that nearly every world includes, for users who have no models of Gazebo."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_PLANE = "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"
_MODELS = {
    "ground_plane": f"""<sdf version="1.6"><model name="ground_plane"><static>true</static><link name="link">
        <collision name="collision">{_PLANE}</collision><visual name="visual">{_PLANE}
        <material><diffuse>0.7 0.7 0.7 1</diffuse></material></visual></link></model></sdf>""",
    "sun": """<sdf version="1.6"><light type="directional" name="sun"><cast_shadows>true</cast_shadows>
        <pose>0 0 10 0 0 0</pose><diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light></sdf>""",
}


def usual_model(uri: str) -> Element | None:
    """The element ``sdf`` of a floor or a sun that is not installed; None for any other model."""
    name = uri.rstrip("/").rpartition("/")[2].lower().replace(" ", "_")
    text = _MODELS.get(name)
    return None if text is None else ElementTree.fromstring(text)
