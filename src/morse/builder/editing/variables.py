"""The statements of a scene script that concern one variable."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from morse.builder.editing.source import name_of

if TYPE_CHECKING:
    from morse.builder.editing.source import Source


class Variable(NamedTuple):
    """A component that the script creates.

    Attributes:
        name: of the variable.
        creation: the assignment.
        calls: statements ``name.method(...)``, by position.
        assignments: statements ``name.attribute = ...`` and ``name.attribute[0] = ...``.
        others: other statements that use the variable.
    """

    name: str
    creation: ast.Assign
    calls: list[ast.Expr]
    assignments: list[ast.Assign | ast.AugAssign]
    others: list[ast.stmt]

    def calls_of(self, method: str) -> list[ast.Call]:
        """The calls of a method."""
        calls = [statement.value for statement in self.calls if isinstance(statement.value, ast.Call)]
        return [call for call in calls if name_of(call.func) == f"{self.name}.{method}"]

    def last_placement(self) -> ast.stmt:
        """The last statement that sets the pose, or else the creation."""
        methods = {f"{self.name}.{method}" for method in ("translate", "rotate")}
        placing: list[ast.stmt] = [self.creation]
        placing += [s for s in self.calls if isinstance(s.value, ast.Call) and name_of(s.value.func) in methods]
        placing += [s for s in self.assignments if attribute_of(s) in ("location", "rotation_euler")]
        return max(placing, key=lambda statement: statement.lineno)


def attribute_of(statement: ast.Assign | ast.AugAssign) -> str:
    """``location`` of ``robot.location = ...``."""
    target = statement.target if isinstance(statement, ast.AugAssign) else statement.targets[0]
    while isinstance(target, ast.Subscript):
        target = target.value
    return target.attr if isinstance(target, ast.Attribute) else ""


def variables(source: Source) -> dict[str, Variable]:
    """The components that the script creates beside its environment, by their names in the scene.

    Variables that get a second value are left out: the name in the scene does not tell which value is meant.
    """
    by_variable: dict[str, Variable] = {}
    ambiguous: set[str] = set()
    for statement in source.block:
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if isinstance(target, ast.Name) and isinstance(statement, ast.Assign):
            if target.id in by_variable or len(statement.targets) > 1:
                ambiguous.add(target.id)
            if isinstance(statement.value, ast.Call):
                by_variable[target.id] = Variable(target.id, statement, [], [], [])
    for node in ast.walk(source.tree):
        if isinstance(node, (ast.Name, ast.arg)) and isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del)):
            variable = by_variable.get(node.id) if isinstance(node, ast.Name) else None
            if variable is not None and node is not variable.creation.targets[0]:
                ambiguous.add(variable.name)
    for statement in source.block:
        for variable in by_variable.values():
            _sort_in(statement, variable)
    usable = {name: variable for name, variable in by_variable.items() if name not in ambiguous}
    return {_name_in_scene(variable): variable for variable in usable.values()}


def _sort_in(statement: ast.stmt, variable: Variable) -> None:
    if statement is variable.creation:
        return
    if not any(isinstance(node, ast.Name) and node.id == variable.name for node in ast.walk(statement)):
        return
    call = statement.value if isinstance(statement, ast.Expr) else None
    if isinstance(call, ast.Call) and name_of(call.func).partition(".")[0] == variable.name:
        assert isinstance(statement, ast.Expr)
        variable.calls.append(statement)
    elif isinstance(statement, (ast.Assign, ast.AugAssign)) and _belongs_to(statement, variable.name):
        variable.assignments.append(statement)
    else:
        variable.others.append(statement)


def _belongs_to(statement: ast.Assign | ast.AugAssign, name: str) -> bool:
    target = statement.target if isinstance(statement, ast.AugAssign) else statement.targets[0]
    while isinstance(target, (ast.Subscript, ast.Attribute)):
        target = target.value
    return isinstance(target, ast.Name) and target.id == name


def _name_in_scene(variable: Variable) -> str:
    """The name that the script gives the component, else that of the variable."""
    name = variable.name
    call = variable.creation.value
    assert isinstance(call, ast.Call)
    for word in call.keywords:
        if word.arg == "name" and isinstance(word.value, ast.Constant) and isinstance(word.value.value, str):
            name = word.value.value
    first = call.args[0] if call.args else None
    is_file = name_of(call.func).rpartition(".")[2] in ("PassiveObject", "Robot", "GroundRobot", "WheeledRobot")
    if isinstance(first, ast.Constant) and isinstance(first.value, str) and not is_file:
        name = first.value
    for statement in variable.assignments:
        value = statement.value
        if attribute_of(statement) == "name" and isinstance(value, ast.Constant) and isinstance(value.value, str):
            name = value.value
    return name
