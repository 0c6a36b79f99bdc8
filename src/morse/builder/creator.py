"""Builder classes of sensors and actuators."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.assets.search import worlds_with
from morse.builder import bpymorse, workspace
from morse.builder.compatibility import call_of_today
from morse.builder.components.component import Component, new_object
from morse.builder.errors import checks
from morse.builder.objects import SceneObject
from morse.core import declarations
from morse.core.classes.builder_defaults import BuilderDefaults, builder_defaults
from morse.core.exceptions import MorseBuilderError, MorseBuilderNoComponentError
from morse.scene import Material, Node, NodeKind
from morse.scene.component import NoiseModel, RealismModel, is_numeric

if TYPE_CHECKING:
    from morse.core.classes.builder_defaults import Visual
    from morse.core.values import Properties
    from morse.scene import Mesh

__all__ = ["ActuatorCreator", "ComponentCreator", "SensorCreator", "bpymorse"]


def noisy_fields(cls: type) -> list[str]:
    """The data fields of a sensor that can have noise: measured numbers, not those that are computed from others."""
    fields = declarations.data_fields(cls)
    measured = {name: entry for name, entry in fields.items() if name != "timestamp" and not entry.follows}
    without = getattr(cls, "without_noise", ())
    return [name for name, entry in measured.items() if is_numeric(entry.default) and name not in without]


class RealisticSensor:
    """The part of the builder class of a sensor that sets phase, delay and noise.

    All errors depend only on the seed of the scene and the name of the sensor: other robots in the scene do not change
    them.
    """

    _realism = RealismModel()

    if TYPE_CHECKING:

        def component_class(self) -> type | None:
            """The class that runs."""

    def phase(self, seconds: float) -> None:
        """Set the time of the first measurement after the start, simulated seconds."""
        what = f"{type(self).__name__}.phase(seconds)"
        self._realism = replace(self._realism, phase=checks.number(seconds, what, minimum=0.0))

    def delay(self, seconds: float) -> None:
        """Set the time from a measurement until its data are published, simulated seconds.

        The time stamp is the time of the measurement.
        """
        what = f"{type(self).__name__}.delay(seconds)"
        self._realism = replace(self._realism, delay=checks.number(seconds, what, minimum=0.0))

    def noise(
        self,
        gaussian: float = 0.0,
        bias_walk: float = 0.0,
        quantization: float = 0.0,
        dropout: float = 0.0,
        field: str | None = None,
    ) -> None:
        """Add noise; call it again for other fields.

        Args:
            gaussian: standard deviation of white noise, in the unit of the field.
            bias_walk: standard deviation of the bias after one second.
            quantization: step of the values.
            dropout: probability, 0..1, that a value is lost. A lost value is replaced by the previous value; a lost
                beam of a scanner has no echo.
            field: a data field; None for all fields that are numbers or vectors (for a scanner, the distances; the
                points are computed from them).

        Raises:
            TypeError: a value is not a number.
            ValueError: a number that is negative or not finite.
            MorseBuilderError: the sensor has no such field, or the field is not numeric.
        """
        what = type(self).__name__ + ".noise"
        models = {"gaussian": gaussian, "bias_walk": bias_walk, "quantization": quantization, "dropout": dropout}
        values = {name: checks.number(value, f"{what}({name})", minimum=0.0) for name, value in models.items()}
        if values["dropout"] > 1.0:
            raise ValueError(f"{what}(dropout) takes a probability from 0 to 1, got {dropout:g}")
        if field is not None:
            self._check_field(checks.text(field, f"{what}(field)"), what)
        noise = {**self._realism.noise, field or "": NoiseModel(**values)}
        self._realism = replace(self._realism, noise=noise)

    def _check_field(self, field: str, what: str) -> None:
        cls = self.component_class()
        fields = {} if cls is None else declarations.data_fields(cls)
        names = [] if cls is None else noisy_fields(cls)
        if field in names or (cls is None):
            return
        if field in fields and fields[field].follows:
            followed = ", ".join(map(repr, fields[field].follows))
            raise MorseBuilderError(f"{what}(field): '{field}' is computed from {followed}, which can have noise")
        if field in fields:
            raise MorseBuilderError(
                f"{what}(field): '{field}' is not a measured number{checks.suggestion(field, names)}"
            )
        raise MorseBuilderError(
            f"{what}(field): {type(self).__name__} has no data field '{field}'{checks.suggestion(field, names)}"
        )

    def _scene_options(self) -> Properties:
        """The part of the declaration that depends on the kind of component."""
        return {} if self._realism == RealismModel() else {"realism": self._realism}


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
