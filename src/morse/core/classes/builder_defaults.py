"""Declarations of a component class for the builder classes that scene scripts use."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import Properties


@dataclass(frozen=True, slots=True)
class Visual:
    """The small shape that marks a component in the view.

    Attributes:
        shape: ``cube``, ``sphere`` or ``cylinder``, 2 m in size (or 1 m in radius) before the scale.
        scale: factor for each axis.
        color: RGB, 0..1.
    """

    shape: str
    scale: tuple[float, float, float]
    color: tuple[float, float, float] = (0.8, 0.8, 0.8)


@dataclass(frozen=True, slots=True)
class BuilderDefaults:
    """Initial values of the builder class of a sensor or actuator.

    A component class declares them as ``_builder``. Commercial products that the same class simulates are declared in
    the tuple ``_products``: each becomes a separate builder class.

    Attributes:
        name: name in scene scripts, if it differs from the name of the class.
        frequency: Hz.
        properties: values that differ from the declared defaults.
        visual: a marker, or None.
        model: a model file, or None.
        part: the object of the model file that is used; None for the whole file.
        doc: description of the product, if it differs from the short description of the class.
        source: source of the values of the product; for formulas of a class, see ``_source`` of the class.
    """

    name: str | None = None
    frequency: float = 60.0
    properties: Properties = field(default_factory=dict)
    visual: Visual | None = None
    model: str | None = None
    part: str | None = None
    doc: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class RobotDefaults:
    """Initial values of the builder class of a robot; a robot class declares them as ``_builder``.

    Attributes:
        model: a model file in ``robots``; None for a frame without a body.
        drive: ``ground`` for a robot that moves as one body on the ground, ``wheels`` for a robot whose wheels turn,
            ``free`` for a robot that may move along and about every axis.
        name: name in scene scripts, if it differs from the name of the class.
        properties: values that differ from the declared defaults, and tags.
        rigid_body: True if forces move the body, whatever the model file declares.
        collides: False if nothing collides with the robot, whatever the model file declares.
        builder: class path of the builder class, for a robot whose scripts call more than the derived methods.
    """

    model: str | None = None
    drive: Literal["ground", "wheels", "free"] = "ground"
    name: str | None = None
    properties: Properties = field(default_factory=dict)
    rigid_body: bool = False
    collides: bool = True
    builder: str = ""


def builder_defaults(cls: type, product: str | None = None) -> BuilderDefaults:
    """Return the declaration of a component class for its builder class, or for the builder class of a product.

    Raises:
        LookupError: there is no such product.
    """
    if product is None:
        own_defaults = getattr(cls, "_builder", None)
        return own_defaults if isinstance(own_defaults, BuilderDefaults) else BuilderDefaults()
    for defaults in getattr(cls, "_products", ()):
        if defaults.name == product:
            return defaults  # type: ignore[no-any-return]
    raise LookupError(f"{cls.__name__} has no product '{product}'")


#: function that creates the builder object of a component class that a scene script calls; it returns None if no scene
#: script runs. The builder sets this hook.
describe: Callable[..., Any] | None = None
