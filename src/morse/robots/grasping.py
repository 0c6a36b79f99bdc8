"""Robots with a hand."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest, shown
from morse.core.robot import Robot
from morse.core.services import service

if TYPE_CHECKING:
    from morse.core.world import Body

#: distance between the hand and an object that it can grasp, m
_REACH = 0.5
_TAG, _HAND = "Graspable", "Grasper"


class GraspingRobot(Robot):
    """The base class of robots whose hand takes objects along.

    Attributes:
        hand_bone: the bone of the usual hand.
    """

    hand_bone: ClassVar[str] = ""

    @service
    def grasp(self, grab: bool, obj_name: str | None = None) -> bool:
        """Grasp or release an object with the right hand, or with the part that ``make_grasper`` of the script names.

        Args:
            grab: whether to grasp; False releases the object.
            obj_name: an object with the property ``Graspable``; None for the nearest one. It has to be at most 0.5 m
                away from the hand.

        Returns:
            Whether an object was grasped or released.
        """
        hand = self._hand()
        objects = [
            thing for thing in self.context.world.objects() if thing.parent is hand and thing.properties.get(_TAG)
        ]
        if not grab:
            for thing in objects:
                thing.removeParent()
            return bool(objects)
        if objects:
            return obj_name is None or any(thing.name == obj_name for thing in objects)
        obj = self._within_reach(hand, obj_name)
        if obj is not None:
            obj.setParent(hand)
        return obj is not None

    def _hand(self) -> Body:
        parts = [self.bge_object, *self.bge_object.childrenRecursive]
        hands = [part for part in parts if part.properties.get(_HAND)]
        right = [part for part in parts if part.node.bone == self.hand_bone]
        if not hands and not right:
            raise MorseRPCInvokationError(f"{self.name()} has no hand: make_grasper in the scene script chooses one")
        hand: Body = (hands or right)[0]
        return hand

    def _within_reach(self, hand: Body, name: str | None) -> Body | None:
        """The object of that name, or the nearest one; None if none is within reach."""
        loose = [thing for thing in self.context.world.objects() if thing.properties.get(_TAG) and thing.parent is None]
        if name is not None:
            loose = [thing for thing in loose if thing.name == name]
            if not loose:
                objects = self.context.world.objects_by_name
                reason = "is held already, or is not Graspable" if name in objects else "does not exist"
                raise MorseRPCInvokationError(f"the object {shown(name)} {reason}{nearest(name, objects)}")
        near = [(hand.getDistanceTo(thing), thing.name, thing) for thing in loose]
        return min(((d, n, thing) for d, n, thing in near if d <= _REACH), default=(0.0, "", None))[2]
