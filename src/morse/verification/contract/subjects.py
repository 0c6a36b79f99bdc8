"""The components to check: from a name in the library, or a file, to the call in a scene script."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import morse.builder
from morse.builder import actuators, robots, sensors
from morse.builder.names import catalog
from morse.core.reports.faults import describe, user_frames
from morse.core.reports.quoting import nearest

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator


#: calls in scene scripts for components of the library with arguments
_ARGUMENTS = {
    "Armature": "armature_name='kuka_armature', model_name='kuka_lwr'",
    "CompoundSensor": "[_member]",
}


class SubjectError(Exception):
    """There is nothing to check; the message contains the search."""


@dataclass(frozen=True)
class Subject:
    """A component to check.

    Attributes:
        name: name of the class in scene scripts.
        imports: lines that a scene script begins with.
        arguments: arguments of the call that creates the component.
        source_paths: directories of packages of the user.
        resource_paths: directories of models of the user.
    """

    name: str
    imports: str = ""
    arguments: str = ""
    source_paths: list[str] = field(default_factory=list)
    resource_paths: list[str] = field(default_factory=list)

    @property
    def call(self) -> str:
        """The call in a scene script."""
        return f"{self.name}({self.arguments})"


def subjects(what: str | os.PathLike[str]) -> list[Subject]:
    """The components of a name or a file.

    Args:
        what: the name of a class of `morse.builder`, or the path of a file with classes of components.

    Raises:
        SubjectError: there is no such name or file, or no component in it.
    """
    text = str(what)
    if isinstance(what, Path) or text.endswith(".py") or "/" in text or "\\" in text:
        return _of_file(Path(what).absolute())
    if text not in library() and not _is_installed(text):
        raise SubjectError(
            f"there is no component '{text}' in MORSE (for one of your own, give its file){nearest(text, library())}"
        )
    return [Subject(text, arguments=_ARGUMENTS.get(text, ""))]


def library() -> list[str]:
    """The names of all sensors, actuators and robots of MORSE, sorted."""
    names = {name for module in (sensors, actuators, robots) for name in module.__all__}
    return sorted(name for name in names if not name.endswith("Creator"))


def _is_installed(name: str) -> bool:
    """Whether an installed package provides a component of that name."""
    return bool(getattr(getattr(morse.builder, name, None), "_classpath", None))


def _of_file(file: Path) -> list[Subject]:
    if not file.is_file():
        raise SubjectError(f"there is no file {file}")
    root, module = _place(file)
    try:
        names = list(_components_in(file, module))
    except SyntaxError as error:
        line = "" if error.lineno is None else f":{error.lineno}"
        raise SubjectError(f"{file.name}{line}: SyntaxError: {error.msg}") from None
    if not names:
        raise SubjectError(
            f"{file} has no class of a component: a public class that is derived from Sensor, Actuator or Robot"
        )
    data = root.parent / "data"
    paths = [str(data)] if root.name == "src" and data.is_dir() else []
    return [Subject(name, f"from {module} import {name}", "", [str(root)], paths) for name in names]


def _components_in(file: Path, module: str) -> Iterator[str]:
    for definition in catalog.classes_of(file):
        if definition.bases:
            for entry in catalog.entries(module, definition, with_name=True):
                if entry.product is None:
                    yield definition.name


def _place(file: Path) -> tuple[Path, str]:
    """The folder below which a file is imported, and the name of its module."""
    root = next((folder for folder in file.parents if folder.name == "src"), None)
    if root is None:
        root = file.parent
        while (root / "__init__.py").is_file():
            root = root.parent
    return root, ".".join(file.relative_to(root).with_suffix("").parts)


# The results of a check.


class Fault(NamedTuple):
    """A violation of a rule.

    Attributes:
        rule: its name, see `morse.verification.contract.check.RULES`.
        text: the fault, the expected value, and how to correct it.
        where: file and line of the declaration; empty if there is none.
    """

    rule: str
    text: str
    where: str = ""

    def __str__(self) -> str:
        return f"{self.rule}: {self.text}{f' ({self.where})' if self.where else ''}"


@dataclass
class Report:
    """The outcome of the check of one component.

    Attributes:
        name: its name in scene scripts.
        where: file and line of its class; empty if it could not be loaded.
        robot: class of its robot; the component itself if it is a robot.
        checked: the rules that were checked, in order.
        faults: the violations.
    """

    name: str
    where: str = ""
    robot: str = ""
    checked: list[str] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether the component follows every rule."""
        return not self.faults

    def take(self, rule: str, faults: Iterable[Fault]) -> None:
        """Add faults; what the component raises while they are looked for is a fault, too.

        Args:
            rule: that such an exception breaks.
        """
        try:
            for fault in faults:
                self.faults.append(fault)
        except (Exception, SystemExit) as error:
            frames = user_frames(error.__traceback__)
            where = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else self.where
            self.faults.append(Fault(rule, f"it raises {describe(error).partition(chr(10))[0]}", where))

    def of(self, rule: str) -> list[Fault]:
        """The faults of one rule."""
        return [fault for fault in self.faults if fault.rule == rule]

    def __str__(self) -> str:
        verdict = "keeps the contract" if self.passed else f"breaks it in {len(self.faults)} places"
        return "\n".join([f"{self.name} {verdict}", *(f"  {fault}" for fault in self.faults)])
