"""Writes the changes of a scene into its script, as a person would, and keeps all other lines and comments."""

from __future__ import annotations

import ast
import math
import re
from keyword import iskeyword
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from morse.builder.abstractcomponent import Placement
from morse.builder.editing.changes import UnwritableError
from morse.builder.editing.source import BUILDER, Source, name_of
from morse.builder.editing.variables import Variable, in_scene, is_pure, mountings, variables
from morse.core.validation.names import RESERVED
from morse.helpers.descriptions import robot_file
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Container, Sequence

    from morse.builder.editing.changes import Addition, Changes, Move

#: decimals of lengths and angles: a tenth of a millimetre, of a milliradian
_DECIMALS = 4
_AXES = "xyz"
_WEAKER_THAN_SUMS = (ast.BitOr, ast.BitXor, ast.BitAnd, ast.LShift, ast.RShift)


def changed_script(text: str, changes: Changes, name: str = "the script") -> str:
    """Return the script of a scene with its changes.

    Args:
        text: the script.
        name: of the file, for errors.

    Raises:
        UnwritableError: a change cannot be written.
    """
    source = Source(text, name)
    by_variable = variables(source)
    by_name, mounted = in_scene(by_variable), mountings(by_variable)
    for move in changes.moves:
        variable = by_name.get(move.name)
        own = [] if variable is None or variable.name not in mounted else [mounted[variable.name].statement]
        if variable is not None and variable.is_certain and variable.class_name and variable.is_alone(*own):
            _move(source, variable, move)
        else:
            _place_by_name(source, move)
    for root, below in changes.deletions.items():
        _check_words(source, root)
        variable = by_name.get(root)
        mounting = None if variable is None else mounted.get(variable.name)
        parts = [] if variable is None or not variable.is_certain else _with_its_parts(variable, by_variable)
        is_apart = "." not in root or (mounting is not None and mounting.is_alone)
        if parts and is_apart and all(part.is_plain() for part in parts):
            _delete(source, parts, [] if mounting is None else [mounting.statement])
        else:
            _delete_by_name(source, root, below)
    for name_in_scene, calls in changes.calls.items():
        if name_in_scene not in changes.deletions:
            _call_methods(source, name_in_scene, calls, by_name)
    carriers = {name: variable.name for name, variable in by_name.items()}
    carriers |= {addition.scene_name: addition.name for addition in changes.additions}
    paragraphs = [_lines_of(source, addition, carriers) for addition in changes.additions]
    if paragraphs:
        source.insert_before(source.environment, paragraphs)
    if changes.settings:
        _set_up(source, changes.settings)
    for addition in changes.additions:
        source.need({_class_of(addition.kind)}, _module_of(addition.kind))
    return source.text()


def lines_of_script(text: str) -> dict[str, list[int]]:
    """The lines of a script, from 1, that describe each object and each component, by its name in the scene.

    Raises:
        UnwritableError: the script is not valid, or creates no environment.
    """
    source = Source(text, "the script")
    by_name = in_scene(variables(source))
    return {
        name: sorted({line for one in variable.own() for line in range(one.lineno, (one.end_lineno or one.lineno) + 1)})
        for name, variable in by_name.items()
        if variable.class_name
    }


def variable_name(kind: str, names: Container[str]) -> str:
    """A free name for a new object: ``atrv`` for ``ATRV``, ``cup_blue`` for ``props/kitchen_objects#Cup_Blue``.

    ``arm`` for ``Robot('arm/arm.urdf')``.
    """
    file, _, part = (robot_file(kind) or kind).partition("#")
    own = part or (file.rpartition(":")[2] if ":" in file else PurePosixPath(file).stem)
    stem = re.sub("_+", "_", "".join(c if c.isascii() and c.isalnum() else "_" for c in own)).strip("_")
    stem = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", stem).lower() or "thing"
    stem = f"_{stem}".strip("_") if not stem[0].isdigit() else f"object_{stem}"
    return free_name(stem, lambda name: name in names or iskeyword(name) or name in RESERVED)


# -- additions --------------------------------------------------------------------------------


def _class_of(kind: str) -> str:
    if robot_file(kind) is not None:
        return "Robot"
    if ":" in kind:
        return kind.rpartition(":")[2]
    return "PassiveObject" if "/" in kind or "." in kind else kind


def _module_of(kind: str) -> str:
    """``ranger_sim.builder.robots`` of ``ranger_sim.builder.robots:Ranger``."""
    return kind.rpartition(":")[0] or BUILDER


def _lines_of(source: Source, addition: Addition, carriers: dict[str, str]) -> list[str]:
    name, kind = addition.name, addition.kind
    file, _, part = (robot_file(kind) or kind).partition("#")
    arguments = _quoted(source, file) if robot_file(kind) is not None else ""
    if _class_of(kind) == "PassiveObject":
        arguments = _quoted(source, file) + (f", object_name={_quoted(source, part)}" if part else "")
    lines = [f"{name} = {_class_of(kind)}({arguments})"]
    if addition.has_own_name:
        lines.append(f"{name}.name = {_quoted(source, name)}")
    shift = [new - old for new, old in zip(addition.position, addition.own_position, strict=True)]
    turn = [new - old for new, old in zip(addition.angles, addition.own_angles, strict=True)]
    lines += [*_call(name, "translate", shift)]
    lines += [_turned(name, addition.angles)] if _turns_otherwise(kind) and any(turn) else _call(name, "rotate", turn)
    if addition.scale != (1.0, 1.0, 1.0):
        lines.append(f"{name}.scale = ({', '.join(map(_number, addition.scale))})")
    lines += [f"{name}.{call}" for call in addition.calls]
    if addition.robot:
        if addition.robot not in carriers:
            what = "" if "." in addition.robot else "the robot "
            raise UnwritableError(
                f"{source.name} does not assign {what}'{addition.robot}' to a variable of its own: add the "
                "component by hand"
            )
        part = f", {_quoted(source, addition.part)}" if addition.part else ""
        lines.append(f"{carriers[addition.robot]}.append({name}{part})")
    return lines


# -- components of robots -----------------------------------------------------------------------


def _call_methods(source: Source, name: str, calls: Sequence[str], by_name: dict[str, Variable]) -> None:
    variable = by_name.get(name)
    if variable is None or not variable.class_name:
        raise UnwritableError(
            f"{source.name} does not assign '{name}' to a variable of its own: write {', '.join(calls)} by hand"
        )
    last = max(variable.own(), key=lambda statement: source.place(statement).at)
    source.insert_after(last, [f"{variable.name}.{call}" for call in calls])


def _set_up(source: Source, calls: Sequence[str]) -> None:
    """Call methods of the environment after what the script itself calls there, so that these count."""
    variable = _target_name(source.environment)
    if not variable.isidentifier():
        raise UnwritableError(
            f"{source.name} does not assign the environment to a variable: write env = Environment(...), or "
            f"{', '.join(calls)} by hand"
        )
    statements = source.block[source.place(source.environment).at :]
    last = source.environment
    for statement in statements:
        value = statement.value if isinstance(statement, ast.Expr) else None
        if isinstance(value, ast.Call) and name_of(value.func).partition(".")[0] == variable:
            last = statement
    source.insert_after(last, [f"{variable}.{call}" for call in calls])
    if any("TimeStrategies" in call for call in calls):
        source.need({"TimeStrategies"})


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


def _turns_otherwise(class_name: str) -> bool:
    """Whether a class of the builder gives the angles of ``rotate`` another meaning, as cameras do."""
    import morse.builder

    cls = getattr(morse.builder, class_name, None)
    return isinstance(cls, type) and issubclass(cls, Placement) and cls.rotate is not Placement.rotate


def _turned(name: str, angles: Sequence[float]) -> str:
    return f"{name}.rotation_euler = ({', '.join(map(_number, angles))})"


def _number(value: float) -> str:
    return repr(round(value, _DECIMALS) + 0.0)


# -- moves ------------------------------------------------------------------------------------


def _move(source: Source, variable: Variable, move: Move) -> None:
    shift = [new - old for new, old in zip(move.position, move.old_position, strict=True)]
    turn = [math.remainder(new - old, math.tau) for new, old in zip(move.angles, move.old_angles, strict=True)]
    if variable.class_name == "Zone" and any(round(value, _DECIMALS) for value in turn):
        raise UnwritableError(f"'{move.name}' is a Zone, whose sides follow the axes of the world: undo its rotation")
    lines = _shift(source, variable, "translate", "location", shift)
    if _turns_otherwise(variable.class_name):
        lines += [_turned(variable.name, move.angles)] if any(round(value, _DECIMALS) for value in turn) else []
    else:
        lines += _shift(source, variable, "rotate", "rotation_euler", turn)
    if lines:
        source.insert_after(variable.last_placement(source), lines)


def _shift(source: Source, variable: Variable, method: str, attribute: str, shift: list[float]) -> list[str]:
    """Change the arguments of the only call of a method, or return a call to insert."""
    if not any(round(value, _DECIMALS) for value in shift):
        return []
    calls = variable.calls_of(method)
    if len(calls) != 1 or variable.setters(attribute) or not _is_by_axes(calls[0]):
        return _call(variable.name, method, shift)
    _add(source, calls[0], shift)
    return []


def _is_by_axes(call: ast.Call) -> bool:
    """Whether each argument is the value of one axis."""
    if any(isinstance(value, ast.Starred) for value in call.args) or len(call.args) > len(_AXES):
        return False
    words = [word.arg for word in call.keywords]
    return set(words) <= {*_AXES[len(call.args) :]}


def _add(source: Source, call: ast.Call, shift: Sequence[float]) -> None:
    """Add numbers to the arguments of a call; only the arguments change, not what stands between them."""
    given: dict[str, ast.expr] = dict(zip(_AXES, call.args, strict=False))
    given |= {word.arg: word.value for word in call.keywords if word.arg is not None}
    new = ast.Call(
        func=call.func,
        args=[*call.args],
        keywords=[ast.keyword(arg=word.arg, value=word.value) for word in call.keywords],
    )
    added: list[str] = []
    for axis, value in zip(_AXES, shift, strict=True):
        if not round(value, _DECIMALS):
            continue
        if axis in given:
            result = _sum(source, given[axis], value)
            new.args = [result if old is given[axis] else old for old in new.args]
            for word in new.keywords:
                word.value = result if word.value is given[axis] else word.value
        elif not new.keywords and len(new.args) == _AXES.index(axis) > 0:
            new.args.append(_expression(_number(value)))
            added.append(_number(value))
        else:
            new.keywords.append(ast.keyword(arg=axis, value=_expression(_number(value))))
            added.append(f"{axis}={_number(value)}")
    if added:
        last = max(
            [*call.args, *(word.value for word in call.keywords)], key=lambda node: source.span(node), default=None
        )
        place = source.end_of_arguments(call, last)
        source.edit(place, place, (", " if last is not None else "") + ", ".join(added))
    source.change(call, new)


def _sum(source: Source, node: ast.expr, value: float) -> ast.expr:
    """Note that a number is added to an expression, and return the sum."""
    begin, end = source.span(node)
    number = _literal(node)
    if number is not None:
        text = _number(number + value)
        source.edit(begin, end, text)
        return _expression(text)
    weak = not isinstance(node, (ast.Name, ast.Attribute, ast.Subscript, ast.Call, ast.Constant, ast.BinOp))
    if weak or (isinstance(node, ast.BinOp) and isinstance(node.op, _WEAKER_THAN_SUMS)):
        source.edit(begin, begin, "(")
        source.edit(end, end, ")")
    source.edit(end, end, f" {'-' if value < 0 else '+'} {_number(abs(value))}")
    operator = ast.Sub() if value < 0 else ast.Add()
    return ast.BinOp(left=node, op=operator, right=_expression(_number(abs(value))))


def _expression(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def _literal(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
    except (ValueError, TypeError):
        return None
    return float(value) if isinstance(value, (int, float)) else None


# -- objects without a variable of their own, and deletions ------------------------------------


def _place_by_name(source: Source, move: Move) -> None:
    """Place an object of the world, or one that the script makes in a loop, when everything is there."""
    lines = []
    last = _last_effect(source, [move.name])
    for attribute, new, old in (
        ("location", move.position, move.old_position),
        ("rotation_euler", move.angles, move.old_angles),
    ):
        if all(round(a - b, _DECIMALS) == 0 for a, b in zip(new, old, strict=True)):
            continue
        value = f"({', '.join(map(_number, new))})"
        statement = _placing_by_name(source, move.name, attribute)
        if statement is not None and source.place(statement).at >= last:
            source.edit(*source.span(statement.value), value)
            source.change(statement.value, _expression(value))
        else:
            lines.append(f"bpymorse.get_object({_quoted(source, move.name)}).{attribute} = {value}")
    if lines:
        source.insert_after(source.tree.body[last], lines)
        source.need({"bpymorse"})


def _last_effect(source: Source, names: list[str]) -> int:
    """Index of the statement of the script, from its environment on, after which nothing concerns some objects.

    Raises:
        UnwritableError: the script may end before.
    """
    variable = _target_name(source.environment)
    last = source.top.at
    for index, statement in enumerate(source.tree.body[last:], last):
        words = {node.value for node in ast.walk(statement) if isinstance(node, ast.Constant)}
        if not _is_setting(statement, variable) or not words.isdisjoint(names):
            last = index
    for index, statement in enumerate(source.tree.body):
        if index >= source.top.at or isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
            line = next((node.lineno for node in ast.walk(statement) if _ends_script(node)), None)  # type: ignore[attr-defined]
            if line is not None:
                raise UnwritableError(
                    f"{source.name}, line {line}, may end the script before its last line, where '{names[0]}' would be "
                    "changed: change it by hand"
                )
    return last


def _target_name(statement: ast.stmt) -> str:
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
        return name_of(statement.targets[0])
    return name_of(statement.target) if isinstance(statement, ast.AnnAssign) else ""


def _is_setting(statement: ast.stmt, environment: str) -> bool:
    """Whether a statement changes no object: a definition, a setting of the environment, a line of the editor."""
    if isinstance(statement, (ast.Import, ast.ImportFrom, ast.Pass)):
        return True
    if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
        return not statement.decorator_list
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        called, values = name_of(statement.value.func), [*statement.value.args, *statement.value.keywords]
        mine = called == "bpymorse.delete" or called.rpartition(".")[0] == environment != ""
        return mine and all(map(is_pure, values))
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1 and is_pure(statement.value):
        target = statement.targets[0]
        if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Call):
            return name_of(target.value.func) == "bpymorse.get_object"
        return name_of(target).rpartition(".")[0] == environment != ""
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _ends_script(node: ast.AST) -> bool:
    if isinstance(node, ast.Call):
        return name_of(node.func) in ("exit", "quit", "sys.exit", "os._exit")
    return isinstance(node, ast.Raise) and node.exc is not None and "SystemExit" in ast.dump(node.exc)


def _placing_by_name(source: Source, name: str, attribute: str) -> ast.Assign | None:
    """The last statement by which the editor has placed an object."""
    for statement in reversed(source.tree.body):
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
    last = _last_effect(source, [root, *below])
    source.insert_after(source.tree.body[last], [f"bpymorse.delete({argument})"])
    source.need({"bpymorse"})


def _check_words(source: Source, root: str) -> None:
    """Raise an error if the script refers to a deleted robot, or to what is on it, in words: ``"robot.pose.x"``."""
    part = re.compile(re.escape(root) + (r"(\.|$)" if "." in root else r"\.[^\W\d]"))
    for node in ast.walk(source.tree):
        shows = isinstance(node, ast.Call) and name_of(node.func).endswith(".show")
        for word in ast.walk(node) if shows else (node,):
            text = word.value if isinstance(word, ast.Constant) and isinstance(word.value, str) else ""
            if part.match(text) or (shows and text == root):
                line = getattr(word, "lineno", 1)
                raise UnwritableError(f"{source.name}, line {line}, uses '{text}': delete '{root}' there by hand")


def _with_its_parts(variable: Variable, by_variable: dict[str, Variable]) -> list[Variable]:
    """A component and all that is appended to it; empty if one of these has no variable of its own.

    Raises:
        UnwritableError: other statements use one of them.
    """
    parts = {variable.name: variable}
    for part in (waiting := [variable]):
        for call in part.calls_of("append", "add_sensors"):
            for node in (node for argument in call.args for node in ast.walk(argument)):
                if isinstance(node, ast.Name) and node.id not in parts:
                    if node.id not in by_variable:
                        return []
                    parts[node.id] = by_variable[node.id]
                    waiting.append(by_variable[node.id])
    return [*parts.values()]


def _delete(source: Source, parts: list[Variable], mounting: Sequence[ast.stmt] = ()) -> None:
    statements = {id(one): one for one in (*mounting, *(one for part in parts for one in part.own()))}
    for part in parts:
        lines = [statement.lineno for statement in part.foreign if id(statement) not in statements]
        lines += [] if part.foreign_line is None else [part.foreign_line]
        if lines:
            raise UnwritableError(
                f"{source.name}, line {lines[0]}, uses '{part.name}': delete '{parts[0].name}' there by hand"
            )
    source.remove([*statements.values()])
