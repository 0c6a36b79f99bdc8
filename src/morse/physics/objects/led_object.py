"""Objects that a linkage moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics.objects.gameobject import GameObject

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.objects.linkage import Linkage
    from morse.physics.objects.mounting import Mounting

    _Pose = tuple[Sequence[float], Sequence[float]]


class LedObject(GameObject):
    """An object that a linkage moves: its poses are computed when they are read.

    It is a separate class, so that the poses of all other objects are read without a check.
    """

    _linkage: Linkage

    @staticmethod
    def lead(obj: GameObject, linkage: Linkage) -> None:
        """Let a linkage move an object from now on."""
        _ = obj.mounting  # computes the pose, if it was invalidated
        obj.__class__ = LedObject
        vars(obj)["_linkage"] = linkage

    @staticmethod
    def leave(obj: GameObject) -> None:
        """Let an object keep its present poses."""
        if isinstance(obj, LedObject):
            obj._linkage.settle()
            obj.__class__ = GameObject  # type: ignore[assignment]
            del vars(obj)["_linkage"]

    @property
    def _local(self) -> _Pose:
        self._linkage.settle()
        pose: _Pose = vars(self)["_local"]
        return pose

    @_local.setter
    def _local(self, pose: _Pose) -> None:
        self._change("_local", pose)

    @property
    def mounting(self) -> Mounting:
        """Pose of the object in its rigid group."""
        self._linkage.settle()
        mounting: Mounting = vars(self)["mounting"]
        return mounting

    @mounting.setter
    def mounting(self, mounting: Mounting) -> None:
        self._change("mounting", mounting)

    def _forget_offset(self) -> None:
        self._take_offset(self._carried_offset())
        self._stamp = -1

    def _change(self, name: str, value: object) -> None:
        """Notify the linkage that the object was moved in another way, so that it reads the pose again."""
        self._linkage.settle()
        self._linkage.is_outdated = True
        vars(self)[name] = value
