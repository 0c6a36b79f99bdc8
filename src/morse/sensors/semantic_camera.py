"""Object recognition."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from morse.core.mathutils import Matrix
from morse.helpers.components import add_data, add_kind, add_property
from morse.mathutils.portable import matmul
from morse.scene.frames import rigid_frame
from morse.sensors.camera import Camera

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.core.world import Body
    from morse.rendering import Lens, Picture

#: minimum number of visible pixels of an object
_FEWEST = 1
#: maximum number of objects with a colour in the image of the live view
_MOST_SHOWN = 200
#: property with the kind of an object
_TYPE = "Type"


def _records(camera: SemanticCamera) -> list[Fields]:
    """Return the objects in the form of messages."""
    return [
        {
            "id": record["name"],
            "label": record["type"],
            "position": record["position"],
            "orientation": record["orientation"],
        }
        for record in camera.local_data["visible_objects"]
    ]


class SemanticCamera(Camera):
    """Lists the visible objects that have a certain property, or whose property ``Type`` has its name as its value.

    An object is visible if at least one pixel of the image shows it. With ``visibility`` ``"ray"``, it is visible as in
    MORSE 1.4: a part of its bounding box is in the field of view, and a ray from the camera to its origin hits it
    first. The ray passes through objects without collision. With ``noocclusion``, occlusion is ignored.
    """

    _name = "Semantic camera"
    _short_desc = "A smart camera allowing to retrieve objects in its field of view"
    #: its items are objects, which no type of a list that is empty at first tells
    without_noise = ("visible_objects",)

    add_data(
        "visible_objects", [], "list<objects>", "Visible objects: name, description, type, position and orientation"
    )

    add_property("relative", False, "relative", "bool", "Poses are in the frame of the camera, not of the world")
    add_property("noocclusion", False, "noocclusion", "bool", "Ignore occlusion")
    add_property("tag", "Object", "tag", "string", "Property that marks objects, or the value of their property Type")
    add_property(
        "visibility",
        "pixels",
        "visibility",
        "string",
        "What decides whether an object is visible: the pixels of the image, or one ray to its origin, as in MORSE 1.4",
        choices=("pixels", "ray"),
    )

    add_kind("detections", records=_records)

    _picture: Picture | None = None
    _shown: Mapping[str, object] = MappingProxyType({})
    color = False
    uses = ("ids", "names")
    relative: bool
    noocclusion: bool
    tag: str
    visibility: str

    def note(self) -> list[tuple[Fields, list[str] | None]] | None:
        """Return the objects that may be visible, for an image with a delay: their data, and their `_candidates`."""
        if not self.request.beside:
            return None
        return [(self._described(thing), names) for thing, names in self._candidates()]

    def take(self, picture: Picture) -> None:
        """Find the objects in an image."""
        numbers, counts = np.unique(picture.ids, return_counts=True)
        self._picture = picture
        names_in_picture = {
            picture.names[n]
            for n, count in zip(numbers.tolist(), counts.tolist(), strict=True)
            if n >= 0 and count >= _FEWEST
        }

        def is_seen(names: list[str] | None) -> bool:
            return names is None or not names_in_picture.isdisjoint(names)

        if self.noted is None:
            descriptions = [self._described(thing) for thing, names in self._candidates() if is_seen(names)]
        else:
            descriptions = [description for description, names in self.noted if is_seen(names)]
        self.local_data["visible_objects"] = descriptions

    def shown(self) -> Mapping[str, object]:
        """A picture in colour, which is rendered while the live view shows it, with the visible objects in boxes."""
        picture = self._picture
        if picture is None or picture.rgba is None:
            return {}
        if self._shown.get("source") is not picture:
            visible = {record["name"] for record in self.local_data["visible_objects"]}
            things = [thing for thing, _ in self._candidates() if str(thing.get("Label", thing.name)) in visible]
            boxes = [self._box(number, thing, picture) for number, thing in enumerate(things[:_MOST_SHOWN], 1)]
            self._shown = {
                "source": picture,
                "image": picture.rgba if self.vertical_flip else picture.rgba[::-1],
                "objects": [box for box in boxes if box is not None],
            }
        return {**self._shown, "timestamp": self.local_data.get("timestamp", 0.0)}

    def _box(self, number: int, thing: Body, picture: Picture) -> Fields | None:
        """The border of an object in the image, px; None if it is not in the image."""
        parts = {node.name for node in thing.node.walk()}
        mask = np.isin(picture.ids, [n for n, name in enumerate(picture.names) if name in parts])
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        if not len(rows):
            return None
        label, kind = str(thing.get("Label", thing.name)), str(thing.get(_TYPE, ""))
        box = (columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
        return {"id": number, "name": label, "class": kind, "box": box}

    def _candidates(self) -> Iterator[tuple[Body, list[str] | None]]:
        """The objects that may be visible, and the names of their meshes; None if no mesh has to be in the image."""
        for thing in self._things():
            if self.visibility == "pixels" and not self.noocclusion:
                yield thing, [node.name for node in thing.node.walk()]
            elif self._is_in_sight(thing) and (self.noocclusion or self._is_first_on_ray(thing)):
                yield thing, None

    def _things(self) -> Iterator[Body]:
        for obj in self.context.world.objects():
            # a false property counts as missing
            if (obj.get(self.tag) or obj.get(_TYPE) == self.tag) and obj.node is not self.bge_object.node:
                yield obj

    def _is_in_sight(self, obj: Body) -> bool:
        """Whether a part of the bounding box of an object is in the field of view."""
        points = [np.zeros((1, 3))]
        position, rotation = self.bge_object.world_pose()
        turn = np.reshape(rotation, (3, 3))
        for node in obj.node.walk():
            part = self.context.world.find_object(node)
            if node.mesh is None or not len(node.mesh.vertices) or part is None or not part.visible:
                continue
            place, own = part.world_pose()
            low, high = node.mesh.vertices.min(axis=0), node.mesh.vertices.max(axis=0)
            corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
            corners = matmul(corners, np.array([list(row) for row in rigid_frame(node).stretch]).T)
            points.append(matmul(matmul(corners, np.reshape(own, (3, 3)).T) + place - position, turn))
        if len(points) == 1:
            points = [(matmul(np.array(obj.world_pose()[0]) - position, turn))[None]]
        return _may_show(np.concatenate(points[1:] or points), self.lens)

    def _is_first_on_ray(self, obj: Body) -> bool:
        """Whether the ray to the origin of an object hits it, a part of it, or the body that it is a part of, first."""
        obstacle = self.bge_object.rayCastTo(obj)
        return obstacle is not None and (obstacle.node in obj.node.walk() or obstacle.node in obj.node.ancestors())

    def _described(self, obj: Body) -> Fields:
        position, rotation = obj.world_pose()
        if self.relative:
            here, camera_rotation = self.bge_object.world_pose()
            frame = np.reshape(camera_rotation, (3, 3))
            position = (matmul(frame.T, np.array(position) - here)).tolist()
            rotation = (matmul(frame.T, np.reshape(rotation, (3, 3)))).ravel().tolist()
        matrix = Matrix([rotation[0:3], rotation[3:6], rotation[6:9]])
        return {
            "name": str(obj.get("Label", obj.name)),
            "description": str(obj.get("Description", "")),
            "type": str(obj.get(_TYPE, "")),
            "position": [float(value) for value in position],
            "orientation": matrix.to_quaternion(),
        }


def _may_show(points: NDArray[np.float64], lens: Lens) -> bool:
    """Whether the hull of points (N, 3) in the frame of the camera may be in the image (separating plane test)."""
    x, y, z = points.T
    left, right = z * -lens.cx <= x * lens.fx, x * lens.fx <= z * (lens.width - lens.cx)
    top, bottom = z * -lens.cy <= y * lens.fy, y * lens.fy <= z * (lens.height - lens.cy)
    return all(bool(side.any()) for side in (left, right, top, bottom, z >= lens.near, z <= lens.far))
