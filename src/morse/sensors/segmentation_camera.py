"""Segmentation images."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from morse.core.mathutils import Matrix
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.mathutils.portable import matmul
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.values import Fields, StateData
    from morse.core.world import Body
    from morse.rendering import Picture
    from morse.rendering.things import Things
    from morse.scene import Node

logger = logging.getLogger(__name__)

#: largest id, because pixels have the encoding 16UC1
_MOST = 65535
#: the class of robots
_ROBOT = "robot"
#: properties that determine the objects and their classes
_OF_LABELS = {"tag", "class_tag", "class_names"}


def _ids(camera: SegmentationCamera) -> NDArray[np.uint16]:
    """(H, W), the top row first."""
    return camera.top_first(camera.local_data["image"])


def _records(camera: SegmentationCamera) -> list[Fields]:
    """Return the visible objects in the form of messages."""
    fields = ("position", "orientation", "size", "box")
    return [
        {"id": record["name"], "label": record["class"], **{key: record[key] for key in fields if key in record}}
        for record in camera.local_data["objects"]
    ]


class SegmentationCamera(Camera):
    """Measures for each pixel the id and the class of the object that it shows.

    An object in this sense is an object with the property named by ``tag``, with all its parts; a robot with all its
    components; or a tree of the remaining objects of the environment. The id of an object does not change while the
    simulation runs. Its class is the property named by ``class_tag``; robots without this property have the class
    ``robot``, and other objects without it have the class id 0.
    """

    _name = "Segmentation camera"
    _short_desc = "A camera that measures the id and the class of the object in each pixel"

    add_data(
        "image",
        np.zeros((0, 0), np.uint16),
        "buffer",
        "Id of the object in each pixel; 0 for none",
        frame="optical",
        shape=(None, None),
        dtype="uint16",
        low=0,
        high=_MOST,
    )
    add_data(
        "classes",
        np.zeros((0, 0), np.uint16),
        "buffer",
        "Id of the class of the object in each pixel; 0 for none",
        frame="optical",
        shape=(None, None),
        dtype="uint16",
        low=0,
        high=_MOST,
    )
    add_data("labels", [], "list<objects>", "All objects of the scene: id, name, class_id, class")
    add_data(
        "objects",
        [],
        "list<objects>",
        "Visible objects: id, name, class, number of pixels, bounding box (x0, y0, x1, y1) in px; and the box in "
        "space: position of its centre and size in m, orientation",
    )
    add_data("intrinsic_matrix", **INTRINSIC)

    add_property("tag", "Object", "tag", "string", "Property that marks objects")
    add_property("class_tag", "Type", "class_tag", "string", "Property with the class of an object")
    add_property(
        "class_names", "", "class_names", "string", "Classes with the ids 1, 2, ...: 'robot, wall'; others follow"
    )
    add_property("relative", False, "relative", "bool", "Boxes are in the frame of the camera, not of the world")
    add_property("fewest_pixels", 1, "fewest_pixels", "integer", "Objects with fewer pixels are not reported", low=1)

    add_property(
        "compression",
        "",
        "compression",
        "string",
        "Format of image files in streams over the socket, instead of plain ids",
        choices=("", "png"),
    )

    add_kind("image", pixels=_ids, encoding="16UC1")
    add_kind("camera_info", **CAMERA_INFO)
    add_kind("detections", topic="detections", records=_records)

    add_state("_class_ids", dict, "Ids of the classes")
    add_state("_thing_ids", dict, "Ids of the objects, which stay the same when objects are added or removed")

    color = False
    uses = ("ids",)
    noise_mend = "because ids cannot have noise"
    without_noise = ("image", "classes")
    #: PNG files have no quality setting
    quality = 100

    tag: str
    class_tag: str
    class_names: str
    relative: bool
    fewest_pixels: int
    compression: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        #: ids by name, which stay the same when objects are added or removed
        self._class_ids = self._named_classes()
        self._thing_ids: dict[str, int] = {}
        self._things: Things | None = None
        self._of_nodes: list[Node] | None = None
        self._table: list[Fields] = []

    def _named_classes(self) -> dict[str, int]:
        names = dict.fromkeys(name.strip() for name in str(self.class_names).split(",") if name.strip())
        return {name: number for number, name in enumerate(names, 1)}

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs; other ``class_names`` give all classes new ids."""
        super().set_property(name, value)
        if name == "class_names":
            self._class_ids = self._named_classes()
        if name in _OF_LABELS:
            self._of_nodes = None

    def set_state(self, state: StateData) -> None:
        """Restore a state, and compute the labels from it."""
        super().set_state(state)
        self._of_nodes = None

    def note(self) -> dict[str, list[object]] | None:
        """Return all objects, for an image with a delay: it is not complete, so that the visible ones are not known."""
        if not self.request.beside:
            return None
        things = self._known(self.request.server.contents.nodes)
        return {
            "numbers": things.numbers.tolist(),
            "table": [dict(row) for row in self._table],
            "spaces": [self._in_space(number) for number in range(len(self._table))],
        }

    def take(self, picture: Picture) -> None:
        """Determine the objects in the pixels."""
        from morse.rendering.things import patches

        record = self.noted
        numbers = self._known(picture.nodes).numbers if record is None else np.array(record["numbers"], np.int32)
        table = self._table if record is None else record["table"]
        ids = np.array([row["id"] for row in table], np.uint16)
        classes = np.zeros(int(ids.max(initial=0)) + 1, np.uint16)
        classes[ids] = [row["class_id"] for row in table]
        classes[0] = 0
        # one more entry, because -1 stands for no object
        image = np.append(ids[numbers], np.uint16(0))[picture.ids]
        rows = {row["id"]: (number, row) for number, row in enumerate(table) if row["id"]}
        self.local_data["objects"] = [
            {
                "id": patch.number,
                "name": rows[patch.number][1]["name"],
                "class": rows[patch.number][1]["class"],
                "pixels": patch.pixels,
                "box": list(patch.box),
                **(
                    self._in_space(rows[patch.number][0]) if record is None else record["spaces"][rows[patch.number][0]]
                ),
            }
            for patch in patches(image)
            if patch.pixels >= self.fewest_pixels
        ]
        self.local_data["image"], self.local_data["classes"] = self.ordered(image), self.ordered(classes[image])
        self.local_data["labels"] = [dict(row) for row in table]

    def _known(self, nodes: list[Node]) -> Things:
        """Return the objects of the scene."""
        if self._things is None or self._of_nodes is not nodes:
            from morse.rendering.things import Things

            robots = {robot.bge_object.node for robot in self.context.robots.values()}
            self._things = Things(self.context.world, nodes, robots, self.tag)
            self._of_nodes = nodes
            self._table = [self._label(node, node in robots) for node in self._things.nodes]
        return self._things

    def _label(self, node: Node, is_robot: bool) -> Fields:
        obj = self.context.world.object_of(node)
        kind = str(obj.get(self.class_tag, _ROBOT if is_robot else ""))
        return {
            "id": self._number(self._thing_ids, node.name),
            "name": str(obj.get("Label", node.name)),
            "class_id": self._number(self._class_ids, kind) if kind else 0,
            "class": kind,
        }

    def _number(self, numbers: dict[str, int], name: str) -> int:
        if name not in numbers and len(numbers) >= _MOST:
            logger.warning("%s: there is no id left for '%s': its id is 0", self.name(), name)
            return 0
        return numbers.setdefault(name, len(numbers) + 1)

    def _in_space(self, number: int) -> Fields:
        """Return the bounding box of an object in the frame given by ``relative``."""
        assert self._things is not None
        box = self._things.box(number)
        if box is None:
            return {}
        position, rotation = box.position, box.rotation
        if self.relative:
            here, camera_rotation = self.bge_object.world_pose()
            frame = np.reshape(camera_rotation, (3, 3))
            position, rotation = matmul(frame.T, position - here), matmul(frame.T, rotation)
        return {
            "position": position.tolist(),
            "orientation": Matrix(rotation.tolist()).to_quaternion(),
            "size": box.size.tolist(),
        }

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because noise cannot be added to ids."""
        return ()
