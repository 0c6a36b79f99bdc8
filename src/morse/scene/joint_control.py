"""How the joints of an armature are moved: by the physics or not, and what their motors control."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.scene.articulation import CONTROL, DYNAMIC, Articulation, Control

if TYPE_CHECKING:
    from morse.scene.node import Node


def is_dynamic(armature: Node) -> bool:
    """Whether the physics moves the joints of a node: if its file has masses, or if a script asks for it."""
    return bool(armature.bones) and bool(armature.properties.get(DYNAMIC, armature.articulation is not None))


def controls_of(armature: Node) -> dict[str, Control]:
    """Return the control mode of the motor of each joint of an armature."""
    settings = armature.articulation or Articulation()
    word = armature.properties.get(CONTROL)
    common = Control(word) if isinstance(word, str) and word in list(Control) else None
    control = dict(settings.control)
    controls = {}
    for bone in armature.bones:
        own = bone.dynamics.control if bone.dynamics is not None else None
        controls[bone.name] = control.get(bone.name) or common or own or Control.POSITION
    return controls
