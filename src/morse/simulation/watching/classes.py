"""Replaces the class of a component whose file was saved, and keeps its state."""

from __future__ import annotations

import ast
import logging
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from morse.assets.following import same
from morse.core.classes.project_imports import ProjectImports
from morse.core.context import acting
from morse.core.datastream import AbstractDatastream
from morse.core.declarations import data_fields, properties
from morse.core.exceptions import MorseError
from morse.core.state import Reader, References, StateError, Writer
from morse.simulation.loader import check_kinds, make_component, make_modifier
from morse.simulation.states.saving import StateParts
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from morse.core.declarations import DataField
    from morse.core.modifier import AbstractModifier
    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.values import Fields
    from morse.scene import ComponentDeclaration
    from morse.simulation.simulation import Simulation


# Transfers the state of a component to the component of the edited class that replaces it.

_MISSING: object = object()
_COMPONENT = "component "


class _Replaced:
    """The parts of a simulation in which some components have been replaced; see `References`."""

    def __init__(self, parts: References, components: Mapping[str, Object]) -> None:
        self._parts = parts
        self._components = components

    def name_of(self, value: object) -> str | None:
        return self._parts.name_of(value)

    def find(self, name: str) -> object:
        if name.startswith(_COMPONENT) and name.removeprefix(_COMPONENT) in self._components:
            return self._components[name.removeprefix(_COMPONENT)]
        return self._parts.find(name)

    def find_class(self, path: str) -> type | None:
        return self._parts.find_class(path)

    def met_class(self, cls: type) -> None:
        self._parts.met_class(cls)

    def global_name(self, value: object) -> str | None:
        return self._parts.global_name(value)

    def find_global(self, name: str) -> object:
        return self._parts.find_global(name)


class Inheritance:
    """Transfers the state of objects to the objects that replace them.

    Args:
        parts: parts of the simulation by name.
        components: new components by name.
    """

    def __init__(self, parts: References, components: Mapping[str, Object]) -> None:
        references = _Replaced(parts, components)
        self._writer = Writer(references)
        self._reader = Reader(references, trusted=True)

    def component(self, name: str, old: Object, new: Object) -> None:
        """Transfer the state of a component.

        Properties and data fields with default values get the defaults of the new class, and so do attributes that the
        old component did not have.

        Raises:
            StateError: the state does not match the new class.
        """
        fields = dict.copy(new.local_data)
        values = {python_name: deepcopy(getattr(new, python_name)) for python_name in properties(type(new))}
        requests = list(new.requests)
        state = self._state(name, old, new)
        if isinstance(state, dict):
            if isinstance(state.get("local_data"), dict):
                _adapt_fields(state["local_data"], fields, data_fields(type(old)), data_fields(type(new)))
            for python_name in _new_defaults(old, new):
                state[python_name] = values[python_name]
        new.set_state(state)
        new.requests = requests
        new.on_completion = old.on_completion
        if name in new.context.failed:
            new.active = True

    def modifier(self, name: str, old: Any, new: Any) -> None:
        """Transfer the state of a modifier.

        Raises:
            StateError: the state does not match the new class.
        """
        new.set_state(self._state(name, old, new))

    def _state(self, name: str, old: Any, new: Any) -> Any:
        before, own = old.get_state(), new.get_state()
        state = self._reader.part(name, self._writer.part(name, before), new.get_state())
        if not isinstance(own, dict):
            return state
        if not isinstance(state, dict):
            raise StateError(
                f"{name}: the state of the old class is not a dictionary, but the state of the new class is"
            )
        # threads and open files cannot be transferred
        values = {key: value for key, value in state.items() if key in own or not (value is None and before[key])}
        return {**own, **values}


def _adapt_fields(data: Fields, fresh: Fields, before: Mapping[str, DataField], after: Mapping[str, DataField]) -> None:
    """Arrange data by the fields of the new class, in order; fields that were added by others are kept."""
    values = {name: value for name, value in dict.items(data) if name not in before or name in after}
    for name in fresh:
        if name in before and name in after and _kind(before[name]) != _kind(after[name]):
            values.pop(name, None)
    data.clear()
    data.update({**fresh, **values})


def _kind(field: DataField) -> tuple[object, ...]:
    return field.type, field.shape, field.dtype, field.angle, field.quaternion


def _new_defaults(old: Object, new: Object) -> list[str]:
    """Return the properties that get the values of the new class."""
    before = properties(type(old))
    names = []
    for python_name, prop in properties(type(new)).items():
        default = before.get(python_name)
        unset = default is not None and same(getattr(old, python_name, _MISSING), default.default)
        if default is None or default.type != prop.type or (unset and not same(default.default, prop.default)):
            names.append(python_name)
    return names


def to_renew(changed: Iterable[str], running: Iterable[str], sources: Mapping[str, str]) -> set[str]:
    """Return the changed modules and the modules that import them, as far as running classes need them.

    Args:
        changed: names of modules.
        running: the modules of the classes in use.
        sources: the modules of the project, and their files.

    Raises:
        SyntaxError: a file is not valid Python.
        OSError: a file cannot be read.
    """
    imports = {name: set(_imports(name, Path(file), sources)) for name, file in sources.items()}
    importers = {name: {other for other in imports if name in imports[other]} for name in sources}
    return _reached(changed, importers) & _reached(running, imports)


def _reached(first: Iterable[str], ways: Mapping[str, set[str]]) -> set[str]:
    dependents: set[str] = set()
    waiting = [name for name in first if name in ways]
    while waiting:
        name = waiting.pop()
        if name not in dependents:
            dependents.add(name)
            waiting += ways[name]
    return dependents


def _imports(module: str, path: Path, modules: Mapping[str, str]) -> Iterator[str]:
    """Iterate over the known modules that a file imports, at any place in the file."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(read_regular(path), str(path))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            names = [base, *(f"{base}.{alias.name}" for alias in node.names)]
        yield from (name for name in names if name in modules and name != module)


logger = logging.getLogger(__name__)


def exchange(simulation: Simulation, files: list[str]) -> list[str]:
    """Reimport files of the project, and replace the components and modifiers whose classes depend on them.

    Returns:
        The names of the components that were replaced, or whose modifiers were replaced.

    Raises:
        Exception: any error in the files or the new classes; the simulation is then unchanged.
    """
    project = simulation.scene.project
    if not isinstance(project, ProjectImports):
        return []
    sources = project.sources()
    names = [name for name, file in sources.items() if file in files]
    return _Exchange(simulation, project).run(names, sources)


class _Exchange:
    def __init__(self, simulation: Simulation, project: ProjectImports) -> None:
        self._simulation = simulation
        self._project = project
        self._context = simulation.context
        self._old: dict[str, Object] = {}
        self._new: dict[str, Object] = {}
        #: name of the component, index of the modifier, and the new modifier
        self._modifiers: list[tuple[str, int, object]] = []

    def run(self, modules_changed: list[str], sources: dict[str, str]) -> list[str]:
        present = list(self._present())
        modules = {module for _, component in present for module in _modules(component)}
        modules |= {module for d, c in present for modifier in _modifiers(d, c) for module in _modules(modifier)}
        names = to_renew(modules_changed, modules, sources)
        if not names:
            return []
        try:
            with acting(self._context), self._project.renewed(names):
                self._make(present, names)
                self._inherit()
        except BaseException:
            for part in [*self._new.values(), *(modifier for _, _, modifier in self._modifiers)]:
                self._simulation.finalize_one(part)
            raise
        with acting(self._context), self._project:
            for declaration, _ in present:
                self._put_in(declaration)
        self._simulation.schedule()
        return [d.name for d, _ in present if d.name in self._new or any(d.name == n for n, _, _ in self._modifiers)]

    def _present(self) -> Iterator[tuple[ComponentDeclaration, Object]]:
        """The components, robots first."""
        declarations = self._simulation.scene.components
        for declaration in sorted(declarations, key=lambda component: component.kind != "robot"):
            component = self._context.component(declaration.name)
            if component is not None:
                yield declaration, component

    def _make(self, present: list[tuple[ComponentDeclaration, Object]], names: set[str]) -> None:
        robots = {d.node: component for d, component in present if d.kind == "robot"}
        for declaration, component in present:
            new = component
            if names & _modules(component):
                robot = None if declaration.kind == "robot" else robots[declaration.robot]
                self._old[declaration.name] = component
                new = self._new[declaration.name] = make_component(self._context, declaration, robot)  # type: ignore[arg-type]
                if declaration.kind == "robot":
                    robots[declaration.node] = new
            for number, modifier in enumerate(_modifiers(declaration, component)):
                if names & _modules(modifier):
                    modifier_copy = make_modifier(new, declaration, declaration.modifiers[number])
                    self._modifiers.append((declaration.name, number, modifier_copy))

    def _inherit(self) -> None:
        inheritance = Inheritance(StateParts(self._simulation), self._new)
        for name, new in self._new.items():
            inheritance.component(name, self._old[name], new)
        for name, number, modifier in self._modifiers:
            declaration = next(d for d in self._simulation.scene.components if d.name == name)
            component = self._context.component(name)
            assert component is not None
            inheritance.modifier(f"{name}, modifier {number}", _modifiers(declaration, component)[number], modifier)
        check_kinds([(d, self._new[d.name]) for d in self._simulation.scene.components if d.name in self._new])

    # -- changes to the simulation, which are not undone -----------------------------------

    def _put_in(self, declaration: ComponentDeclaration) -> None:
        name = declaration.name
        if name in self._new:
            self._replace(declaration, self._old[name], self._new[name])
        component = self._context.component(name)
        assert component is not None
        present = _modifiers(declaration, component)
        for owner, number, modifier in self._modifiers:
            if owner == name:
                objects = self._simulation.loaded.modifier_objects
                before = present[number]
                objects[:] = [modifier if one is before else one for one in objects]
                present[number] = modifier
                self._simulation.finalize_one(before)

    def _replace(self, declaration: ComponentDeclaration, old: Object, new: Object) -> None:
        context, parts, name = self._context, self._simulation.loaded, declaration.name
        tables: list[dict[str, Any]] = [context.robots, context.components]
        for table in tables:
            if table.get(name) is old:
                table[name] = new
        groups: list[list[Any]] = [parts.robots, parts.actuators, parts.sensors]
        for components in groups:
            components[:] = [new if one is old else one for one in components]
        for part in context.components.values():
            if cast("object", part.robot_parent) is old:
                part.robot_parent = cast("Robot", new)
        context.sensing.replace(old, new)
        new.input_modifiers, new.output_modifiers = old.input_modifiers, old.output_modifiers
        for modifier in [*new.input_modifiers, *new.output_modifiers]:
            cast("AbstractModifier", modifier).component_instance = new
        self._connect(declaration, old, new)
        context.failed.discard(name)
        self._simulation.finalize_one(old)

    def _connect(self, declaration: ComponentDeclaration, old: Object, new: Object) -> None:
        context, name = self._context, declaration.name
        streams = [stream for manager in context.stream_managers.values() for stream in manager.streams.get(name, ())]
        for stream in declaration.streams:
            manager = context.stream_managers.get(stream.manager)
            try:
                if manager is not None:
                    manager.connect(new, stream)
            except MorseError as error:
                logger.error("[ERROR][MORSE] %s: a stream does not match the new class: %s", name, error)
        new.input_functions += [call for call in old.input_functions if not _is_stream(call, streams)]
        new.output_functions += [call for call in old.output_functions if not _is_stream(call, streams)]
        context.services.replace(name, old, new)
        for overlay in context.overlays.values():
            if overlay.overlaid_object is old:
                overlay.overlaid_object = new
                context.services.register_object(overlay.name(), overlay)
        self._simulation.component_replaced(old, new)


def _modules(part: object) -> set[str]:
    """Return the modules of the class of an object and of its bases."""
    return {cls.__module__ for cls in type(part).__mro__}


def _modifiers(declaration: ComponentDeclaration, component: Object) -> list[Any]:
    """The modifiers of a component, in the order of the scene script."""
    return component.output_modifiers if declaration.kind == "sensor" else component.input_modifiers


def _is_stream(call: Callable[..., object], streams: Sequence[object]) -> bool:
    owner = getattr(call, "__self__", None)
    return isinstance(owner, AbstractDatastream) or any(owner is stream for stream in streams)
