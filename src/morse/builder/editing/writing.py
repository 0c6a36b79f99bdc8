"""Writes the changes of a scene into its script, as a person would, and keeps all other lines and comments."""

from __future__ import annotations

import ast
import math
import re
from keyword import iskeyword
from typing import TYPE_CHECKING

from morse.builder.editing.changes import UnwritableError
from morse.builder.editing.imports import BUILDER, import_names
from morse.builder.editing.source import Source, name_of
from morse.builder.editing.variables import Variable, attribute_of, variables
from morse.core.validation.names import RESERVED
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Container, Sequence

    from morse.builder.editing.changes import Addition, Changes, Move

#: decimals of lengths and angles: a tenth of a millimetre, of a milliradian
_DECIMALS = 4
_AXES = "xyz"


def changed_script(text: str, changes: Changes, name: str = "the script") -> str:
    """Return the script of a scene with its changes.

    Args:
        text: the script.
        name: of the file, for errors.

    Raises:
        UnwritableError: a change cannot be written.
    """
    source = Source(text, name)
    by_name = variables(source)
    for move in changes.moves:
        variable = by_name.get(move.name)
        if variable is None:
            _place_by_name(source, move)
        else:
            _move(source, variable, move)
    for root, below in changes.deletions.items():
        variable = by_name.get(root)
        if variable is None:
            _delete_by_name(source, root, below)
        else:
            _delete(source, variable, by_name)
    robots = {name: variable.name for name, variable in by_name.items()}
    robots |= {addition.name: addition.name for addition in changes.additions}
    paragraphs = [_lines_of(source, addition, robots) for addition in changes.additions]
    if paragraphs:
        source.insert_before_environment(paragraphs)
    for module in {_module_of(addition.kind) for addition in changes.additions}:
        additions = [addition for addition in changes.additions if _module_of(addition.kind) == module]
        import_names(source, {_class_of(addition.kind) for addition in additions}, module)
    result = source.text()
    ast.parse(result)
    return result


def variable_name(kind: str, names: Container[str]) -> str:
    """A free name for a new object: ``atrv`` for ``ATRV``, ``cup_blue`` for ``props/kitchen_objects#Cup_Blue``."""
    own = kind.rpartition("#")[2].rpartition("/")[2].rpartition(":")[2]
    stem = re.sub("_+", "_", "".join(c if c.isascii() and c.isalnum() else "_" for c in own)).strip("_")
    stem = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", stem).lower() or "thing"
    stem = f"_{stem}".strip("_") if not stem[0].isdigit() else f"object_{stem}"
    return free_name(stem, lambda name: name in names or iskeyword(name) or name in RESERVED)


# -- additions --------------------------------------------------------------------------------


def _class_of(kind: str) -> str:
    if ":" in kind:
        return kind.rpartition(":")[2]
    return "PassiveObject" if "/" in kind or "." in kind else kind


def _module_of(kind: str) -> str:
    """``ranger_sim.builder.robots`` of ``ranger_sim.builder.robots:Ranger``."""
    return kind.rpartition(":")[0] or BUILDER


def _lines_of(source: Source, addition: Addition, robots: dict[str, str]) -> list[str]:
    name, kind = addition.name, addition.kind
    file, _, part = kind.partition("#")
    arguments = ""
    if _class_of(kind) == "PassiveObject":
        arguments = _quoted(source, file) + (f", object_name={_quoted(source, part)}" if part else "")
    lines = [f"{name} = {_class_of(kind)}({arguments})"]
    shift = [new - old for new, old in zip(addition.position, addition.own_position, strict=True)]
    turn = [new - old for new, old in zip(addition.angles, addition.own_angles, strict=True)]
    lines += [*_call(name, "translate", shift), *_call(name, "rotate", turn)]
    if addition.robot:
        if addition.robot not in robots:
            raise UnwritableError(
                f"{source.name} does not assign the robot '{addition.robot}' to a variable of its own: add the sensor "
                "by hand"
            )
        lines.append(f"{robots[addition.robot]}.append({name})")
    return lines


def _quoted(source: Source, text: str) -> str:
    written = repr(text)
    return f'"{text}"' if source.quote == '"' and written == f"'{text}'" and '"' not in text else written


def _call(name: str, method: str, values: Sequence[float]) -> list[str]:
    """The call of ``translate`` or ``rotate``; none if it has no effect."""
    numbers = [round(value, _DECIMALS) + 0.0 for value in values]
    if not any(numbers):
        return []
    if method == "rotate" or sum(map(bool, numbers)) == 1:
        words = [f"{axis}={_number(number)}" for axis, number in zip(_AXES, numbers, strict=True) if number]
    else:
        while not numbers[-1]:
            numbers.pop()
        words = [_number(number) for number in numbers]
    return [f"{name}.{method}({', '.join(words)})"]


def _number(value: float) -> str:
    return repr(round(value, _DECIMALS) + 0.0)


# -- moves ------------------------------------------------------------------------------------


def _move(source: Source, variable: Variable, move: Move) -> None:
    shift = [new - old for new, old in zip(move.position, move.old_position, strict=True)]
    turn = [math.remainder(new - old, math.tau) for new, old in zip(move.angles, move.old_angles, strict=True)]
    lines = _shift(source, variable, "translate", "location", shift)
    lines += _shift(source, variable, "rotate", "rotation_euler", turn)
    if lines:
        source.insert_after(variable.last_placement(), lines)


def _shift(source: Source, variable: Variable, method: str, attribute: str, shift: list[float]) -> list[str]:
    """Change the arguments of the only call of a method, or return a call to insert."""
    if not any(round(value, _DECIMALS) for value in shift):
        return []
    calls = variable.calls_of(method)
    assigned = any(attribute_of(statement) == attribute for statement in variable.assignments)
    arguments = None if len(calls) != 1 or assigned else _arguments(calls[0])
    if arguments is None:
        return _call(variable.name, method, shift)
    words = []
    for place, (axis, value) in enumerate(zip(_AXES, shift, strict=True)):
        node = arguments.get(axis)
        text = _sum(source, node, value)
        if place < len(calls[0].args):
            words.append(text or "0.0")
        elif text and (node is not None or round(value, _DECIMALS)):
            positional = place == len(words) and len(words) == len(calls[0].args) and not calls[0].keywords
            words.append(text if positional and method == "translate" and place > 0 else f"{axis}={text}")
    begin, end = source.span(calls[0])
    _, opening = source.span(calls[0].func)
    source.replace(opening, end, f"({', '.join(words)})")
    assert begin < opening
    return []


def _arguments(call: ast.Call) -> dict[str, ast.expr] | None:
    """The arguments by axis; None if they are not single expressions."""
    if any(isinstance(value, ast.Starred) for value in call.args) or len(call.args) > len(_AXES):
        return None
    arguments = dict(zip(_AXES, call.args, strict=False))
    for word in call.keywords:
        if word.arg not in ("x", "y", "z"):
            return None
        arguments[word.arg] = word.value
    return arguments


def _sum(source: Source, node: ast.expr | None, value: float) -> str:
    """An argument with a number added; empty for 0 that is not written."""
    if node is None:
        return _number(value) if round(value, _DECIMALS) else ""
    text = source.segment(node)
    if not round(value, _DECIMALS):
        return text
    number = _literal(node)
    if number is not None:
        return _number(number + value)
    if isinstance(node, (ast.IfExp, ast.Lambda, ast.NamedExpr, ast.BoolOp, ast.Compare)):
        text = f"({text})"
    return f"{text} {'-' if value < 0 else '+'} {_number(abs(value))}"


def _literal(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
    except (ValueError, TypeError):
        return None
    return float(value) if isinstance(value, (int, float)) else None


# -- objects without a variable, and deletions ------------------------------------------------


def _place_by_name(source: Source, move: Move) -> None:
    """Place an object of the world, or one that the script makes in a loop, when everything is there."""
    lines = []
    for attribute, new, old in (
        ("location", move.position, move.old_position),
        ("rotation_euler", move.angles, move.old_angles),
    ):
        if all(round(a - b, _DECIMALS) == 0 for a, b in zip(new, old, strict=True)):
            continue
        value = f"({', '.join(map(_number, new))})"
        statement = _placing_by_name(source, move.name, attribute)
        if statement is not None:
            source.replace(*source.span(statement.value), value)
        else:
            lines.append(f"bpymorse.get_object({_quoted(source, move.name)}).{attribute} = {value}")
    if lines:
        source.insert_after(source.environment, lines)
        import_names(source, {"bpymorse"})


def _placing_by_name(source: Source, name: str, attribute: str) -> ast.Assign | None:
    for statement in source.block:
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if not isinstance(target, ast.Attribute) or target.attr != attribute or not isinstance(target.value, ast.Call):
            continue
        call = target.value
        arguments = [argument.value for argument in call.args if isinstance(argument, ast.Constant)]
        if name_of(call.func) == "bpymorse.get_object" and arguments == [name] and isinstance(statement, ast.Assign):
            return statement
    return None


def _delete_by_name(source: Source, root: str, below: list[str]) -> None:
    names = [_quoted(source, name) for name in (root, *below)]
    argument = names[0] if len(names) == 1 else f"[{', '.join(names)}]"
    source.insert_after(source.environment, [f"bpymorse.delete({argument})"])
    import_names(source, {"bpymorse"})


def _delete(source: Source, variable: Variable, by_name: dict[str, Variable]) -> None:
    parts = [variable]
    for call in variable.calls_of("append"):
        part = next((one for one in by_name.values() if call.args and name_of(call.args[0]) == one.name), None)
        if part is not None:
            parts.append(part)
    own = {id(statement) for one in parts for statement in (one.creation, *one.calls, *one.assignments)}
    for one in parts:
        foreign = next((statement for statement in one.others if id(statement) not in own), None)
        if foreign is not None:
            raise UnwritableError(
                f"{source.name}, line {foreign.lineno}, uses '{one.name}': delete '{variable.name}' there by hand"
            )
    for statement in {id(s): s for one in parts for s in (one.creation, *one.calls, *one.assignments)}.values():
        source.remove(statement)
