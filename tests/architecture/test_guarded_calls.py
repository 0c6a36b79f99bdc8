"""Code of users is called through the guard: calls outside of it are found in the syntax trees of the simulator."""

import ast
from collections.abc import Iterator
from pathlib import Path

import morse

ROOT = Path(morse.__file__).parent
#: the rooms that call parts of users; others are such parts themselves
ROOMS = ("core", "simulation", "launch", "viewer", "recording", "services")
#: methods of parts that may be code of users, called by the simulation
METHODS = frozenset((
    "action", "default_action", "update_pose", "modify", "before_tick", "after_tick", "restarted", "rearranged",
    "edited", "viewpoint_changed", "report_pace", "take_input", "remember", "observe", "serve", "release_delayed",
))  # fmt: skip
#: those that parts of the simulator pass on to their own parts
NOTIFICATIONS = frozenset(("after_tick", "restarted", "rearranged", "edited"))
#: lists of functions of users
LISTS = frozenset((
    "input_functions", "output_functions", "before_physics", "reviews", "observers", "sinks",
    "_subscribers", "_callbacks", "input_modifiers", "output_modifiers",
))  # fmt: skip
#: a part that calls another one of its own in turn, within the guard of its caller
WITHIN = {
    # the actions of components, which the tick calls within the guard
    ("core/abstractobject.py", "default_action"), ("core/actuator.py", "default_action"),
    ("core/actuator.py", "take_input"), ("core/sensor.py", "default_action"), ("core/robot.py", "default_action"),
    ("core/realism.py", "default_action"), ("core/external_object.py", "take_input"),
    ("core/external_object.py", "action"), ("core/datastream.py", "action"),
    # asked by the guard of `serve`, and passed to `Guard.each`
    ("core/requests.py", "serve"), ("simulation/ticks/ticking.py", "action"),
    ("simulation/ticks/ticking.py", "update_pose"),
    ("core/rows/rows.py", "default_action"), ("core/rows/rows.py", "remember"),
    ("core/rows/rows.py", "observe"), ("core/sensor.py", "observe"), ("simulation/ticks/ticking.py", "observe"),
    # passed to `Guard.each`
    ("core/guard.py", "before_tick"), ("core/guard.py", "after_tick"), ("core/sensor.py", "action"),
    # listens at a port
    ("core/clients/network.py", "serve"),
}  # fmt: skip


def unguarded(source: str, path: str) -> list[str]:
    """The calls of code of users outside of the guard, as lines for a message."""
    tree = ast.parse(source)
    safe = {id(node) for node in _guarded(tree)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and id(node) not in safe:
            name = _method(node)
            if name is not None and (path, name) not in WITHIN:
                found.append(f"{path}:{node.lineno}: {ast.unparse(node)}")
    for loop in ast.walk(tree):
        if isinstance(loop, ast.For) and isinstance(loop.target, ast.Name) and _list_of(loop.iter) in LISTS:
            found += [
                f"{path}:{node.lineno}: {ast.unparse(node)}"
                for node in ast.walk(loop)
                if isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id == loop.target.id
                and id(node) not in safe
            ]
    return found


def _method(call: ast.Call) -> str | None:
    func = call.func
    if not isinstance(func, ast.Attribute) or func.attr not in METHODS:
        return None
    owner = func.value
    while isinstance(owner, (ast.Attribute, ast.Call)):
        owner = owner.value if isinstance(owner, ast.Attribute) else owner.func
    is_told = func.attr in NOTIFICATIONS and isinstance(owner, ast.Name) and owner.id in ("self", "simulation")
    return None if is_told or (isinstance(owner, ast.Name) and owner.id == "super") else func.attr


def _list_of(iterated: ast.expr) -> str | None:
    while isinstance(iterated, ast.Call) and len(iterated.args) == 1:
        iterated = iterated.args[0]
    return iterated.attr if isinstance(iterated, ast.Attribute) else None


def _guarded(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes in a lambda that is passed to the guard, or in a `try` that catches every error."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Try) and any(_takes_all(handler) for handler in node.handlers):
            for statement in node.body:
                yield from ast.walk(statement)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and _is_guard(node.func.value):
            for argument in node.args:
                yield from ast.walk(argument)


def _takes_all(handler: ast.ExceptHandler) -> bool:
    return isinstance(handler.type, ast.Name) and handler.type.id == "BaseException"


def _is_guard(value: ast.expr) -> bool:
    return (value.attr if isinstance(value, ast.Attribute) else getattr(value, "id", "")).strip("_") == "guard"


def test_all_calls_of_code_of_users_are_guarded() -> None:
    found = []
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if name != "core/guard.py":
                found += unguarded(path.read_text(encoding="utf-8"), name)
    assert found == [], "call it through a function of core/guard.py"


def test_the_check_sees_calls_outside_of_the_guard() -> None:
    source = """
for observer in self.observers:
    observer.after_tick()
for push in list(self.before_physics):
    push()
modifier.modify()
try:
    component.action()
except Exception as error:
    log(error)
"""
    lines = [int(line.split(":")[1]) for line in unguarded(source, "core/some.py")]
    assert sorted(lines) == [3, 5, 6, 8]


def test_the_check_accepts_guarded_calls() -> None:
    source = """
guard.each(observers, lambda observer: observer.after_tick(), off)
try:
    component.action()
except BaseException as error:
    guard.deactivate(component, error)
super().action()
"""
    assert unguarded(source, "core/some.py") == []
