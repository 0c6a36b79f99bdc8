"""Robots, sensors and actuators that a project defines for its scene scripts, as ``morse add`` writes them."""

from __future__ import annotations

import importlib
import logging
from pathlib import Path
from typing import TYPE_CHECKING

from morse.builder.abstractcomponent import AbstractComponent
from morse.core.classes.project_imports import offers
from morse.core.reports.faults import ENDINGS, describe
from morse.helpers.descriptions import OWN_CLASS

if TYPE_CHECKING:
    from collections.abc import Iterable

logger = logging.getLogger(__name__)

_FOLDERS = ("robots", "sensors", "actuators")


def own_classes(sources: Iterable[str]) -> list[tuple[str, str]]:
    """Kind and name of each class; to be called in the block of the imports of the project.

    Args:
        sources: folders with the packages of the project.

    Returns:
        Kinds such as ``ranger_sim.builder.robots:Ranger``. A module with an error is left out, with a warning.
    """
    kinds: list[tuple[str, str]] = []
    for folder in (Path(source) / package for source in sources for package in _packages(source)):
        for below in _FOLDERS:
            if not (folder / "builder" / below).is_dir():
                continue
            module = f"{folder.name}.builder.{below}"
            try:
                names = vars(importlib.import_module(module))
            except ENDINGS:
                raise
            except BaseException as error:
                logger.warning("the classes of %s are left out: %s", module, describe(error))
                continue
            kinds += [
                (f"{module}:{name}", name)
                for name, value in names.items()
                if isinstance(value, type)
                and issubclass(value, AbstractComponent)
                and value.__module__.startswith(f"{folder.name}.")
            ]
    return kinds


def _packages(source: str) -> list[str]:
    return sorted(path.parent.name for path in Path(source).glob("*/builder") if path.is_dir())


def own_class(kind: str) -> type[AbstractComponent] | None:
    """The class of a kind of `own_classes`, in the block of the imports of its project; None for any other text."""
    parts = OWN_CLASS.fullmatch(kind)
    # the kind may come from a client: nothing but code of the project is imported for it
    if parts is None or not offers(parts[1]):
        return None
    value = getattr(importlib.import_module(kind.rpartition(":")[0]), parts[3], None)
    return value if isinstance(value, type) and issubclass(value, AbstractComponent) else None
