"""Components with a model file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.scene import Node

if TYPE_CHECKING:
    from morse.scene import Role

_KINDS = {"robots": "robot", "sensors": "sensor", "actuators": "actuator"}


class Component(AbstractComponent):
    """A component with the body of a model file.

    Args:
        category: folder of the model: ``robots``, ``sensors``, ``actuators``, ``props`` ...
        filename: name of the model (see `morse.assets.find`); empty for an object without a body.
        blender_object_name: the root object in the file; None for the object without a parent.
        make_morseable: whether to assign the component class of a robot, sensor or actuator, if it is known.

    Raises:
        FileNotFoundError: the model does not exist.
        MorseBuilderNoComponentError: the model does not contain the object.
    """

    _role: Role = "component"

    def __init__(
        self,
        category: str = "",
        filename: str = "",
        blender_object_name: str | None = None,
        make_morseable: bool = True,
    ) -> None:
        if not isinstance(filename, str):
            raise TypeError(f"the model of a {type(self).__name__} is given by its name, got {checks.shown(filename)}")
        super().__init__(filename=filename, category=category)
        self._kind = self._kind or _KINDS.get(category, "")
        if filename:
            self.set_blender_object(self._load(blender_object_name))
        else:
            self.set_blender_object(new_object(type(self).__name__))
        if make_morseable and self._kind and not self.is_morseable() and getattr(type(self), "_classpath", None):
            self.morseable()

    def _load(self, root_name: str | None) -> SceneObject:
        if root_name is not None:
            nodes = self.append_meshes(objects=[root_name])
            return nodes[0]
        return self.append_model()


def new_object(name: str) -> SceneObject:
    """A new object without a body."""
    node = Node(name)
    workspace.current().add(node)
    return SceneObject(node)
