"""Components without a simulation, for tests of message kinds."""

import copy
from types import SimpleNamespace
from typing import Any

from morse.core.clock import Clock
from morse.core.declarations import data_fields, properties
from morse.core.kinds import bind
from morse.helpers.transformation import Transformation3d
from morse.scene import TimeStrategies


def made(cls: type, **data: Any) -> Any:
    """A replacement for a component of a class: its data and properties as declared."""
    component = cls()
    component.local_data = {name: copy.deepcopy(field.default) for name, field in data_fields(cls).items()} | data
    for python_name, prop in properties(cls).items():
        setattr(component, python_name, prop.default)
    component.clock = Clock(60.0, TimeStrategies.FixedSimulationStep)
    component.context = SimpleNamespace(strict=False)
    component.level = getattr(component, "level", None)
    for name in ("field_changes", "kind_members"):
        if not hasattr(cls, name):
            setattr(component, name, {})
    component.position_3d = Transformation3d()
    component.robot_parent = None
    component.output_modifiers, component.input_modifiers = [], []
    component.name = lambda: "robot." + cls.__name__.lower()
    return component


def spoken(cls: type, **data: Any) -> Any:
    """The only message kind of a class."""
    (bound,) = bind(made(cls, **data))
    return bound
