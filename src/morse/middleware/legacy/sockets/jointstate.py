"""The joint values of a PR2 over the socket, under the name of MORSE 1.4."""

from __future__ import annotations

from morse.middleware.socket.streams import SocketPublisher
from morse.wire.encoding import to_json

_CASTERS = [
    f"{corner}_caster_{part}_joint"
    for corner in ("fl", "fr", "bl", "br")
    for part in ("rotation", "l_wheel", "r_wheel")
]
_ARM = (
    *("shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll"),
    *("gripper", "gripper_l_finger", "gripper_r_finger", "gripper_r_finger_tip", "gripper_l_finger_tip"),
    *("gripper_motor_screw", "gripper_motor_slider"),
)
#: the joints that a PR2 reports
JOINTS = (
    *_CASTERS,
    *("torso_lift_joint", "torso_lift_motor_screw_joint"),
    *("head_pan_joint", "head_tilt_joint", "laser_tilt_mount_joint"),
    *(f"{side}_{part}_joint" for side in ("r", "l") for part in _ARM),
)


class PR2JointStatePublisher(SocketPublisher):
    """One object with ``timestamp`` and all joints of a PR2, rad or m; joints that no sensor measures are 0."""

    def encode(self) -> bytes:
        """The message."""
        positions: dict[str, float] = {}
        for joints in self.data.values():
            if isinstance(joints, dict):
                positions.update(joints)
        return to_json({"timestamp": self.data["timestamp"], **{name: positions.get(name, 0.0) for name in JOINTS}})
