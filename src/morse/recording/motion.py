"""Poses and appearance of everything that moves or changes, so that a run can be shown without simulating it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from morse.helpers.transformation import Transformation3d
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.names import MAP
from morse.rosmsgs.parts import header_at, quaternion, quaternion_of, xyz
from morse.rosmsgs.table import Qos

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.world import Body
    from morse.rosmsgs.topics.backend import Backend

POSES, NODES, LOOKS = "/morse/poses", "/morse/nodes", "/morse/appearance"
TOPICS = (POSES, NODES, LOOKS)
POSES_TYPE, TEXT_TYPE = "geometry_msgs/msg/PoseArray", "std_msgs/msg/String"


class Motion:
    """Publishes the poses of all moving nodes in the world in every tick, their names, and changes of appearance.

    Attributes:
        repainted: objects whose appearance has changed since the last `publish_looks`.

    Args:
        context: of the simulation.
        backend: receives the messages.
    """

    def __init__(self, context: Context, backend: Backend) -> None:
        self._world = context.world
        self._poses = backend.publisher(POSES, POSES_TYPE, Qos(100))
        self._nodes = backend.publisher(NODES, TEXT_TYPE, Qos(1, latched=True))
        self._looks = backend.publisher(LOOKS, TEXT_TYPE, Qos(1000))
        self.repainted: set[Any] = set()
        self._last_looks: dict[str, Any] = {}
        self._names: list[str] | None = None
        self._world.repaint_sinks.append(self.repainted.add)
        self.follow()

    def close(self) -> None:
        """Stop observing the world."""
        if self.repainted.add in self._world.repaint_sinks:
            self._world.repaint_sinks.remove(self.repainted.add)

    def follow(self) -> None:
        """The objects may have changed."""
        self._layout = -1
        self._objects: list[Any] = []
        self._is_new = True

    # -- a tick ------------------------------------------------------------------------------

    def publish(self, stamp: int) -> None:
        """Publish the poses, and what has changed, encoded in the tick.

        Args:
            stamp: simulated time, ns.
        """
        self.renew()
        self.publish_looks()
        if self._poses is not None:
            self._poses.publish(self.message(stamp))

    @property
    def channel(self) -> int:
        """The id of the channel of poses in the file; -1 if they are not in a file."""
        return getattr(self._poses, "number", -1)

    def renew(self) -> list[object]:
        """Publish the names of the nodes if they have changed, and return their objects."""
        world = self._world
        if world.layout != self._layout or self._is_new:
            self._layout = world.layout
            self._name_nodes()
        if self._is_new:
            self._is_new = False
            # restored objects do not report their appearance
            self.repainted.update(world.objects())
        return self._objects

    def _name_nodes(self) -> None:
        world = self._world
        nodes = [node for node, _ in world.moving_nodes()]
        self._objects = [world.object_of(node) for node in nodes]
        self._snapshots = world.snapshots(self._objects)
        names = [node.name for node in nodes]
        if self._nodes is not None and names != self._names:
            self._names = names
            self._nodes.publish(encode(TEXT_TYPE, {"data": json.dumps(names)}))

    def message(self, stamp: int) -> bytes:
        """Return the message of the present poses, encoded in the tick."""
        snapshot, origin = self._snapshots.now(), Transformation3d()
        poses = []
        for row in range(len(snapshot.slots)):
            pose = Transformation3d()
            pose.set_pose(*snapshot.pose(row))
            relative = origin.transformation3d_with(pose)
            poses.append(
                {
                    "position": xyz((relative.x, relative.y, relative.z)),
                    "orientation": quaternion(quaternion_of(relative)),
                }
            )
        return encode(POSES_TYPE, {"header": header_at(stamp, MAP), "poses": poses})

    # -- appearance --------------------------------------------------------------------------

    def publish_looks(self) -> None:
        """Publish the appearance of the objects that have changed."""
        if not self.repainted:
            return
        looks = []
        for obj in sorted((one for one in self.repainted if not one.invalid), key=lambda one: str(one.name)):
            look = look_of(obj)
            if self._last_looks.get(obj.name) != look:
                self._last_looks[obj.name] = look
                looks.append({"name": obj.name, **look})
        self.repainted.clear()
        if looks and self._looks is not None:
            self._looks.publish(encode(TEXT_TYPE, {"data": json.dumps(looks)}))


def look_of(obj: Body) -> dict[str, Any]:
    """The appearance of an object that can change while the simulation runs."""
    node, light = obj.node, obj.node.light
    return {
        "visible": bool(obj.visible),
        "color": None if node.color is None else [float(value) for value in node.color],
        "light": None
        if light is None
        else {
            "color": [float(value) for value in light.color],
            "energy": float(light.energy),
            "distance": float(light.distance),
            "spot_size": float(light.spot_size),
        },
    }
