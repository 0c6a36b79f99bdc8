"""Names components after the variables of the script that refer to them.

Names have several sources; a stronger source replaces a weaker one:

1. a variable that referred to the component when it was used (`Strength.GUESSED`),
2. a variable or attribute that refers to it when it is appended, when `close_context` is called or when the environment
   is created (`Strength.VARIABLE`),
3. a name that the script gave (`Strength.GIVEN`).
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.names.frames import user_frames
from morse.builder.names.part import Part, Strength
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import FrameType

logger = logging.getLogger(__name__)


def check_given_name(name: object) -> str:
    """A name that a script gives to a component.

    Raises:
        TypeError: the name is not a string.
        ValueError: the name is empty.
        SyntaxError: the name contains a dot.
    """
    if not isinstance(name, str):
        raise TypeError(f"the name of a component is a string, got {name!r}")
    if not name.strip():
        raise ValueError("the name of a component cannot be empty")
    if "." in name:
        raise SyntaxError(
            f"the name '{name}' contains a dot: dots separate robots from their components (robot.arm.pose); write "
            f"'{name.replace('.', '_')}'"
        )
    return name


def check_address(name: str) -> None:
    """Validate the name of a robot, sensor or actuator for use by clients.

    Raises:
        ValueError: the name contains a space, which separates the words of a request.
    """
    if any(character.isspace() or not character.isprintable() for character in name):
        address = "_".join("".join(c if c.isprintable() else " " for c in name).split())
        raise ValueError(f"the name {name!r} contains a space, which clients cannot send; write '{address}'")


def name_in_frame(component: Part, parent: Part, frame: FrameType) -> str | None:
    """Return the name of a component that is being appended to a parent.

    The name is that of an attribute of ``self``, else of a variable, else of an attribute of the parent.
    """
    owner = frame.f_locals.get("self")
    attributes = getattr(owner, "__dict__", {}) if owner is not component else {}
    places = (attributes, frame.f_locals, frame.f_globals, parent.__dict__)
    return next((name for place in places if (name := _holder(component, place)) is not None), None)


def _holder(component: Part, variables: Mapping[str, object]) -> str | None:
    return next((name for name, value in variables.items() if value is component and _usable(name)), None)


def _usable(name: str) -> bool:
    return name.isidentifier() and name != "self" and not name.startswith("_")


def name_unparented(variables: Mapping[str, object], strength: Strength) -> None:
    """Name the components among these variables that have no parent."""
    for name, value in list(variables.items()):
        if isinstance(value, Part) and _usable(name) and value.is_complete and value.parent is None:
            value.suggest_name(name, strength)


def guess_names() -> None:
    """Record which variables refer to which components, before the variables change.

    The component may be created by the ``__init__`` of a class of the user, in a loop of the script.
    """
    for frame in user_frames():
        name_unparented(frame.f_locals, Strength.GUESSED)


def rename_all() -> None:
    """Give every component its name in the simulation: ``robot.arm.pose`` for a component of a robot."""
    used_names: set[str] = set()
    for component in workspace.current().components:
        if component.parent is None:
            _rename_tree(component, (), used_names, component.is_robot)


def _rename_tree(component: Part, prefix: tuple[str, ...], used_names: set[str], on_robot: bool) -> None:
    path = (*prefix, component.plain_name)
    # an object keeps its name in the file, unless a variable still refers to it
    if not on_robot and component.name_strength < Strength.VARIABLE:
        name = component.name
    else:
        wanted = ".".join(path)
        name = free_name(wanted, used_names.__contains__, first=1, digits=3)
        if name != wanted and component.name_strength is Strength.GIVEN:
            logger.warning(
                "two components have the name '%s': the later one is called '%s'; give it another name",
                wanted,
                name,
                extra={"where": component._where},
            )
        workspace.current().claim(component.scene_node, name)
        path = (*prefix, name.rpartition(".")[2])
    used_names.add(name)
    for child in component.children:
        _rename_tree(child, path if on_robot else (), used_names, on_robot)
