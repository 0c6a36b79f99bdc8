"""The statements of a scene script that concern one variable."""

from __future__ import annotations

import ast
import inspect
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from morse.builder.editing.source import bound_names, name_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.builder.editing.source import Source

Assignment = ast.Assign | ast.AnnAssign | ast.AugAssign

#: methods that neither use nor change the pose of a component
_ELSEWHERE = frozenset(
    [
        "add_default_interface",
        "add_interface",
        "add_overlay",
        "add_sensors",
        "add_service",
        "add_stream",
        "alter",
        "append",
        "close_context",
        "delay",
        "frequency",
        "gains",
        "level",
        "make_external",
        "make_ghost",
        "make_grasper",
        "mark_unexportable",
        "morseable",
        "noise",
        "profile",
        "properties",
        "set_collision",
        "set_color",
        "set_damping",
        "set_friction",
        "set_mass",
        "set_no_collision",
        "set_physics_type",
        "set_restitution",
        "set_rigid_body",
        "set_use_record_animation",
        "setgraspable",
    ]
)
#: functions that have no effect, so that their calls may be left out
_PURE = frozenset(
    [
        "abs",
        "bool",
        "dict",
        "float",
        "int",
        "len",
        "list",
        "max",
        "min",
        "radians",
        "range",
        "round",
        "set",
        "str",
        "sum",
        "tuple",
    ]
)


@dataclass
class Variable:
    """What a call returns that the script assigns to a variable, which never gets another value.

    Attributes:
        name: of the variable.
        creation: the assignment.
        scene_name: name of the component in the scene; empty if the script does not tell.
        is_certain: whether nothing else of the script refers to this name, and thereby to the component.
        calls: statements ``name.method(...)`` of the block of the environment.
        assignments: statements ``name.attribute = ...`` and ``name.attribute[0] = ...`` of it.
        foreign: the other statements of the block that use the variable.
        foreign_line: line of the first use that is in none of the statements above, or None.
    """

    name: str
    creation: ast.Assign | ast.AnnAssign
    scene_name: str = ""
    is_certain: bool = True
    calls: list[ast.Expr] = field(default_factory=list)
    assignments: list[Assignment] = field(default_factory=list)
    foreign: list[ast.stmt] = field(default_factory=list)
    foreign_line: int | None = None

    @property
    def call(self) -> ast.Call:
        """The call."""
        assert isinstance(self.creation.value, ast.Call)
        return self.creation.value

    @property
    def class_name(self) -> str:
        """The class that is called, by the convention for names; empty for a function, which may return anything."""
        name = name_of(self.call.func).rpartition(".")[2]
        return name if name[:1].isupper() else ""

    def is_alone(self, *mountings: ast.stmt) -> bool:
        """Whether it is used only in its own statements, and in those that attach it."""
        return self.foreign_line is None and all(one in mountings for one in self.foreign)

    def own(self) -> list[ast.stmt]:
        """The statements that concern this variable only."""
        return [self.creation, *self.calls, *self.assignments]

    def is_plain(self) -> bool:
        """Whether its own statements have no effect on anything else, so that the script can do without them."""
        values: list[ast.AST | None] = [*self.call.args, *self.call.keywords, *(one.value for one in self.assignments)]
        for statement in self.calls:
            assert isinstance(statement.value, ast.Call)
            values += [*statement.value.args, *statement.value.keywords]
        return bool(self.class_name) and all(value is None or is_pure(value) for value in values)

    def calls_of(self, *methods: str) -> list[ast.Call]:
        """The calls of some methods."""
        calls = [statement.value for statement in self.calls if isinstance(statement.value, ast.Call)]
        return [call for call in calls if name_of(call.func) in {f"{self.name}.{method}" for method in methods}]

    def setters(self, attribute: str = "") -> list[ast.stmt]:
        """Statements, beside calls of ``translate`` and ``rotate``, that may set the pose, or one attribute of it."""
        known = {id(call) for call in self.calls_of(*_ELSEWHERE, "translate", "rotate")}
        other = {"location": "rotation_euler", "rotation_euler": "location"}.get(attribute)
        found: list[ast.stmt] = [one for one in self.calls if id(one.value) not in known]
        return found + [one for one in self.assignments if attribute_of(one) not in ("name", "scale", other)]

    def last_placement(self, source: Source) -> ast.stmt:
        """The last statement that may set the pose, or else the creation."""
        turns = {id(call) for call in self.calls_of("translate", "rotate")}
        placing = [self.creation, *(one for one in self.calls if id(one.value) in turns), *self.setters()]
        return max(placing, key=lambda statement: source.place(statement).at)


def attribute_of(statement: Assignment) -> str:
    """``location`` of ``robot.location[0] = ...``; empty if the target is no attribute of a variable."""
    target, attribute = _target(statement), ""
    while isinstance(target, (ast.Subscript, ast.Attribute)):
        if isinstance(target, ast.Attribute):
            attribute = target.attr
        target = target.value
    return attribute if isinstance(target, ast.Name) else ""


def variables(source: Source) -> dict[str, Variable]:
    """What the script creates beside its environment, and before it, by the names of the variables."""
    bound = Counter(name for node in ast.walk(source.tree) for name in bound_names(node))
    found: dict[str, Variable] = {}
    for statement in source.block[: source.place(source.environment).at]:
        if isinstance(statement, (ast.Assign, ast.AnnAssign)) and isinstance(statement.value, ast.Call):
            target = _target(statement)
            if isinstance(target, ast.Name) and bound[target.id] == 1:
                found[target.id] = Variable(target.id, statement)
    seen: set[int] = set()
    for statement in source.block:
        uses = Counter(node.id for node in ast.walk(statement) if isinstance(node, ast.Name))
        seen.update(id(node) for node in ast.walk(statement))
        for name in found.keys() & uses.keys():
            _sort_in(statement, found[name], uses[name])
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Name) and node.id in found and id(node) not in seen:
            found[node.id].foreign_line = found[node.id].foreign_line or node.lineno
    words = Counter(node.value for node in ast.walk(source.tree) if isinstance(node, ast.Constant))
    named = _names_components(source.environment)
    for variable in found.values():
        given = [*_given_names(variable)]
        if given:
            variable.scene_name = given[-1] or ""
        elif named and not variable.name.startswith("_"):
            variable.scene_name = variable.name
        variable.is_certain = words[variable.scene_name] == bool(given)
    return found


class Mounting(NamedTuple):
    """How the script attaches a component.

    Attributes:
        owner: what carries it.
        statement: the statement.
        is_alone: whether the statement attaches nothing else.
    """

    owner: Variable
    statement: ast.Expr
    is_alone: bool


def mountings(found: dict[str, Variable]) -> dict[str, Mounting]:
    """How components are attached, by the names of their variables."""
    mounted: dict[str, Mounting] = {}
    for owner in found.values():
        methods = {f"{owner.name}.append", f"{owner.name}.add_sensors"}
        for statement in owner.calls:
            call = statement.value
            if not isinstance(call, ast.Call) or name_of(call.func) not in methods:
                continue
            nodes = [node for argument in call.args for node in ast.walk(argument)]
            words = [node.id for node in nodes if isinstance(node, ast.Name)]
            others = [one for one in call.args if not isinstance(one, ast.Name)]
            is_plain = all(isinstance(one, ast.Constant) for one in (*others, *(word.value for word in call.keywords)))
            for word in words:
                if word in found and word != owner.name:
                    mounted[word] = Mounting(owner, statement, len(words) == 1 and is_plain)
    return mounted


def in_scene(found: dict[str, Variable]) -> dict[str, Variable]:
    """Variables by the names of their robots, objects and components in the scene, such as ``robot.arm.camera``."""
    mounted = mountings(found)

    def full_name(variable: Variable, above: tuple[str, ...] = ()) -> str:
        mounting = mounted.get(variable.name)
        if mounting is None or not variable.scene_name:
            return variable.scene_name
        if variable.name in above:  # a script that cannot run
            return ""
        owner = full_name(mounting.owner, (*above, variable.name))
        return owner and f"{owner}.{variable.scene_name}"

    names = {variable.name: full_name(variable) for variable in found.values()}
    count = Counter(names.values())
    return {name: found[word] for word, name in names.items() if name and count[name] == 1}


def _target(statement: Assignment) -> ast.expr | None:
    """The only target of an assignment."""
    if isinstance(statement, ast.Assign):
        return statement.targets[0] if len(statement.targets) == 1 else None
    return statement.target


def _sort_in(statement: ast.stmt, variable: Variable, uses: int) -> None:
    if statement is variable.creation:
        return
    if uses > 1:
        variable.foreign.append(statement)
    elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        owner = name_of(statement.value.func).partition(".")[0]
        (variable.calls if owner == variable.name else variable.foreign).append(statement)
    elif isinstance(statement, (ast.Assign, ast.AnnAssign, ast.AugAssign)) and _owner(statement) == variable.name:
        variable.assignments.append(statement)
    else:
        variable.foreign.append(statement)


def _owner(statement: Assignment) -> str:
    """``robot`` of ``robot.location[0] = ...``."""
    target = _target(statement)
    while isinstance(target, (ast.Subscript, ast.Attribute)):
        target = target.value
    return name_of(target) if target is not None else ""


def _names_components(environment: ast.stmt) -> bool:
    """Whether the environment names components after variables."""
    words = [word.arg for node in ast.walk(environment) if isinstance(node, ast.Call) for word in node.keywords]
    return "component_renaming" not in words and None not in words


def _given_names(variable: Variable) -> Iterator[str | None]:
    """The names that the script gives a component, the last one counts; None for one that it does not tell."""
    values: list[ast.expr] = []
    if variable.class_name:
        index = _place_of_name(variable.class_name)
        if index is not None and len(variable.call.args) > index:
            values.append(variable.call.args[index])
        values += [word.value for word in variable.call.keywords if word.arg in ("name", None)]
    values += [one.value for one in variable.assignments if attribute_of(one) == "name" and one.value is not None]
    for value in values:
        if not isinstance(value, ast.Constant):
            yield None
        elif value.value is not None:
            yield value.value if isinstance(value.value, str) else None


def _place_of_name(class_name: str) -> int | None:
    """The place of the name among the arguments of a class; classes of projects take it first, as those of MORSE."""
    import morse.builder

    cls = getattr(morse.builder, class_name, None)
    if cls is None:
        return 0
    parameters = list(inspect.signature(cls).parameters)
    return parameters.index("name") if "name" in parameters else None


def is_pure(value: ast.AST) -> bool:
    """Whether the evaluation of an expression has no effect."""
    for node in ast.walk(value):
        if isinstance(node, (ast.NamedExpr, ast.Await, ast.Yield, ast.YieldFrom)):
            return False
        if (
            isinstance(node, ast.Call)
            and name_of(node.func) not in _PURE
            and not name_of(node.func).startswith("math.")
        ):
            return False
    return True
