"""Builder classes of sensors and actuators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.search import worlds_with
from morse.builder import bpymorse, workspace
from morse.builder.compatibility import call_of_today
from morse.builder.components.component import Component, new_object
from morse.builder.components.realism import RealisticSensor
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.core import declarations
from morse.core.classes.builder_defaults import BuilderDefaults, builder_defaults
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.scene import Material, Node, NodeKind

if TYPE_CHECKING:
    from morse.core.classes.builder_defaults import Visual
    from morse.scene import Mesh

__all__ = ["ActuatorCreator", "ComponentCreator", "SensorCreator", "bpymorse"]

_SHAPES = {"cube": solids.cube, "sphere": solids.sphere, "cylinder": solids.cylinder}


class ComponentCreator(Component):
    """A sensor or actuator.

    Args:
        name: its name, if it differs from the name of the variable or attribute that refers to it.
        category: ``sensors`` or ``actuators``.
        action: ``APPEND_EMPTY`` creates a frame without a body, ``USE_BLEND`` loads a model, ``LINK_EXISTING_OBJECT``
            uses an object that is already in the scene.
        blendfile: name of the model for ``USE_BLEND``.
        blendobject: name of the object in the model, or of the existing object.
        make_morseable: whether to assign its component class.
        classpath: class path of the component class, if the class of the script does not define it.

    Attributes:
        _classpath: class path of the component class; subclasses set it.
        _blendname: name of the model if ``blendfile`` is not given; subclasses may set it.
        _product: name of the product that this class represents, or None for the component class itself.
    """

    APPEND_EMPTY = "APPEND_EMPTY"
    USE_BLEND = "USE_BLEND"
    LINK_EXISTING_OBJECT = "LINK_EXISTING_OBJECT"
    _ACTIONS = (APPEND_EMPTY, USE_BLEND, LINK_EXISTING_OBJECT)

    _classpath: str | None = None
    _blendname: str = ""
    _product: str | None = None
    _role = "casing"

    def __init__(
        self,
        name: str | None = None,
        category: str = "",
        action: str = APPEND_EMPTY,
        blendfile: str | None = None,
        blendobject: str | None = None,
        make_morseable: bool = True,
        classpath: str | None = None,
    ) -> None:
        if action not in self._ACTIONS:
            known = {"action": action, "blendfile": blendfile, "classpath": classpath}
            given = call_of_today(self, "__init__", known, {})
            action, blendfile, classpath = given["action"], given["blendfile"], given["classpath"]
        checks.choice(action, self._ACTIONS, f"{type(self).__name__}(action)")
        model = blendfile or type(self)._blendname
        if action == self.USE_BLEND:
            if not model:
                raise MorseBuilderError(f"{type(self).__name__}: USE_BLEND needs the name of a model: blendfile='...'")
            super().__init__(category, model, blendobject, make_morseable=False)
        else:
            super(Component, self).__init__(filename=model, category=category)
            existing = action == self.LINK_EXISTING_OBJECT
            self.set_blender_object(self._existing(blendobject or name) if existing else self._new())
        self._blendname = model
        if classpath is not None:
            self.morseable(classpath)
        self._load_defaults(make_morseable)
        if name is not None:
            self.name = name

    def _new(self) -> SceneObject:
        return new_object(type(self).__name__)

    def _existing(self, name: str | None) -> SceneObject:
        if name is None:
            raise MorseBuilderError(
                f"{type(self).__name__}: LINK_EXISTING_OBJECT needs the name of an object: blendobject='...'"
            )
        node = workspace.current().find(name)
        if node is None:
            names = workspace.current().names()
            hint = checks.suggestion(name, names) + worlds_with(name)
            raise MorseBuilderNoComponentError(f"there is no object '{name}'{hint}")
        return SceneObject(node)

    def _load_defaults(self, make_morseable: bool) -> None:
        if type(self)._classpath is None and not self.is_morseable():
            self.frequency(BuilderDefaults().frequency)
            return
        if make_morseable and not self.is_morseable():
            self.morseable()
        cls = self.component_class()
        defaults = BuilderDefaults() if cls is None else builder_defaults(cls, type(self)._product)
        self.frequency(defaults.frequency)
        if cls is not None and (not declarations.data_fields(cls) or declarations.says_nothing(cls)):
            self.mark_unexportable()
        self.properties(**defaults.properties)
        if defaults.visual is not None:
            self._add_marker(defaults.visual)
        if defaults.model is not None:
            for body in self._bodies(defaults.model, defaults.part):
                workspace.current().attach(self.scene_node, body.node)

    def _bodies(self, model: str, part: str | None) -> list[SceneObject]:
        return [self.append_model(model)] if part is None else self.append_meshes([part], model)

    def _marker(self, visual: Visual) -> tuple[Mesh, list[Material | None]]:
        shape = _SHAPES[checks.choice(visual.shape, _SHAPES, f"Visual(shape) of {self.classpath}")]
        return shape(), [Material(f"{type(self).__name__}Mesh", (*visual.color, 1.0))]

    def _add_marker(self, visual: Visual) -> None:
        mesh, materials = self._marker(visual)
        marker = Node(f"{type(self).__name__}Mesh", kind=NodeKind.MESH, mesh=mesh, materials=materials)
        marker.scale = list(visual.scale)
        workspace.current().add(marker)
        workspace.current().attach(self.scene_node, marker)


class _KindCreator(ComponentCreator):
    """A component whose kind tells its category."""

    def __init__(
        self,
        name: str | None = None,
        action: str = ComponentCreator.APPEND_EMPTY,
        blendfile: str | None = None,
        blendobject: str | None = None,
        make_morseable: bool = True,
        classpath: str | None = None,
    ) -> None:
        super().__init__(name, f"{self._kind}s", action, blendfile, blendobject, make_morseable, classpath)


class SensorCreator(RealisticSensor, _KindCreator):
    """A sensor; subclasses set the component class (``_classpath``)."""

    _kind = "sensor"


class ActuatorCreator(_KindCreator):
    """An actuator; subclasses set the component class (``_classpath``)."""

    _kind = "actuator"
