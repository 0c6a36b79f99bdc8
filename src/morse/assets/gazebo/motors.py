"""The motors of wheels that plugins drive."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.scene import Control

if TYPE_CHECKING:
    from morse.assets.gazebo.converted import Plugins
    from morse.assets.urdf.structure import Document


def prepare_motors(document: Document, plugins: Plugins) -> None:
    """Set the largest efforts of driven wheels; the wheels of a body that plugins move roll freely."""
    is_pushed = any(one.product == "MotionXYW" for one in plugins.actuators)
    for joint in document.joints:
        torque = plugins.torques.get(joint.name)
        if torque is not None:
            joint.dynamics = replace(joint.dynamics, effort=min(torque, joint.dynamics.effort))
        elif is_pushed and joint.kind in ("revolute", "continuous") and not joint.dynamics.limited:
            joint.dynamics = replace(joint.dynamics, control=Control.EFFORT)
