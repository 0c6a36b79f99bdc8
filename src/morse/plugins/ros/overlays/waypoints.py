"""The action of the navigation stack, for actuators that drive to a point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.overlay import MorseOverlay
from morse.core.services import interruptible
from morse.plugins.ros.overlays import action_type
from morse.rosmsgs.services import ros_action

if TYPE_CHECKING:
    from morse.rosmsgs.topics.backend import RosObject


MoveBaseAction = action_type("MoveBaseAction", "move_base_msgs")


class WayPoint(MorseOverlay):
    """Offers ``goto`` of a `Waypoint` as the action ``move_base``."""

    @interruptible
    @ros_action(type=MoveBaseAction)  # type: ignore[untyped-decorator]
    def move_base(self, goal: RosObject) -> None:
        """Drive to the position of a goal, m, world; its orientation has no effect."""
        position = goal.target_pose.pose.position
        target: Any = self.overlaid_object
        target.goto(self.chain_callback(_without_result), position.x, position.y, position.z)


def _without_result(outcome: tuple[str, object]) -> tuple[str, None]:
    # the result of the action has no fields
    return outcome[0], None
