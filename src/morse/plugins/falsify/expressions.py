"""Requirements as text: a small part of Python's expressions, which says how far a condition is from being violated.

Nothing of an expression is executed by Python. It is parsed, each of its parts is one of those below or is refused, and
names are looked up by a function of the caller: no attribute of any object can be reached.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest, quoted

#: robustness beyond which a condition is as good or as bad as it can be
FAR = 1e9
#: longest text, and greatest exponent
_LONGEST, _GREATEST_EXPONENT = 1000, 16
#: levels of a syntax tree
_DEEPEST = 60

#: the value of a name, given its parts: ``("robot", "pose", "x")``
Look: TypeAlias = Callable[[tuple[str, ...]], Any]
_Value: TypeAlias = Callable[[Look], Any]


class RequirementError(MorseError):
    """A requirement cannot be judged: it is not written correctly, or names something that does not exist."""


class Verdict(NamedTuple):
    """What a condition is at one time.

    Attributes:
        holds: whether it holds.
        robustness: how far it is from the opposite, in the unit of what it compares: positive if it holds, negative if
            it does not; NaN if a value is not a number, and the condition then does not hold.
    """

    holds: bool
    robustness: float


_Condition: TypeAlias = Callable[[Look], Verdict]


def _total(function: Callable[..., float]) -> Callable[..., float]:
    def call(*values: float) -> float:
        try:
            return function(*values)
        except (ValueError, ArithmeticError):
            return math.nan

    return call


def _length(value: Any) -> float:
    return float(len(value))


def _extreme(one: Any, values: tuple[Any, ...]) -> float:
    everything = np.concatenate([np.ravel(np.asarray(value, dtype=float)) for value in values])
    if not everything.size:
        raise NotYetError
    return float(one(everything))


class NotYetError(Exception):
    """A sensor has not measured yet, so that there is nothing to judge."""


_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "abs": (1, np.abs),
    "len": (1, _length),
    "min": (-1, lambda *values: _extreme(np.min, values)),
    "max": (-1, lambda *values: _extreme(np.max, values)),
    "sum": (1, lambda value: float(np.sum(np.asarray(value, dtype=float)))),
    "hypot": (-1, _total(math.hypot)),
    "atan2": (2, _total(math.atan2)),
    **{
        name: (1, _total(getattr(math, name)))
        for name in (
            "acos", "asin", "atan", "ceil", "cos", "degrees", "exp", "floor", "log", "radians", "sin", "sqrt", "tan",
        )
    },
}  # fmt: skip
_METHODS: dict[str, Callable[[Any], float]] = {
    "min": lambda value: _extreme(np.min, (value,)),
    "max": lambda value: _extreme(np.max, (value,)),
    "mean": lambda value: _extreme(np.mean, (value,)),
    "sum": lambda value: float(np.sum(np.asarray(value, dtype=float))),
}
_OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.FloorDiv: lambda a, b: a // b,
    ast.Mod: lambda a, b: a % b,
    ast.Pow: lambda a, b: a**b,
}
_COMPARISONS: dict[type[ast.cmpop], Callable[[float, float], Verdict]] = {
    ast.Lt: lambda a, b: Verdict(a < b, b - a),
    ast.LtE: lambda a, b: Verdict(a <= b, b - a),
    ast.Gt: lambda a, b: Verdict(a > b, a - b),
    ast.GtE: lambda a, b: Verdict(a >= b, a - b),
    ast.Eq: lambda a, b: Verdict(a == b, -abs(a - b)),
    ast.NotEq: lambda a, b: Verdict(a != b, abs(a - b)),
}


class Expression:
    """A condition as text.

    Attributes:
        text: the text.
        names: the names that it contains, each as its parts.

    Raises:
        RequirementError: it is not a condition of the language.
    """

    def __init__(self, text: str) -> None:
        if len(text) > _LONGEST:
            raise RequirementError(f"a requirement has {len(text)} characters; at most {_LONGEST} are read")
        self.text = text.strip()
        self.names: set[tuple[str, ...]] = set()
        try:
            tree = ast.parse(self.text, mode="eval")
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            reason = error.msg if isinstance(error, SyntaxError) else "it is nested too deeply"
            raise RequirementError(f"{quoted(self.text)} is not an expression of Python: {reason}") from None
        if _depth(tree) > _DEEPEST:
            raise RequirementError(f"{quoted(self.text)} is nested too deeply")
        self._root = self._root_of(tree.body)

    def _root_of(self, node: ast.expr) -> _Condition:
        return self._condition(node)

    def judge(self, look: Look) -> Verdict:
        """Return the verdict for the present values.

        Args:
            look: returns the value of a name.

        Raises:
            RequirementError: a value is not of the kind that the expression needs.
            NotYetError: there are no values yet.
        """
        holds, robustness = self._root(look)
        if math.isnan(robustness):
            return Verdict(False, math.nan)
        return Verdict(bool(holds), max(-FAR, min(FAR, float(robustness))))

    # -- conditions ------------------------------------------------------------------------

    def _condition(self, node: ast.expr) -> _Condition:
        match node:
            case ast.BoolOp(op=operator, values=nodes):
                return _joined([self._condition(one) for one in nodes], is_and=isinstance(operator, ast.And))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                inner = self._condition(operand)
                return lambda look: _opposite(inner(look))
            case ast.Compare(left=left, ops=operators, comparators=right):
                return self._comparison(node, [left, *right], operators)
            case ast.BinOp() | ast.Constant(value=int() | float() | str() | bytes() | complex()) if not _is_bool(node):
                raise self._refused(node, "is not a condition: compare it, as in 'a > 0.4'")
        value = self._value(node)
        return lambda look: self._truth(node, value(look))

    def _comparison(self, node: ast.expr, nodes: list[ast.expr], operators: Sequence[ast.cmpop]) -> _Condition:
        for operator in operators:
            if type(operator) not in _COMPARISONS:
                raise self._refused(node, "compares by something else than <, <=, >, >=, == and !=")
        values = [self._value(one) for one in nodes]

        def pair(index: int) -> _Condition:
            compare, operator = _COMPARISONS[type(operators[index])], operators[index]

            def judged(look: Look) -> Verdict:
                a, b = values[index](look), values[index + 1](look)
                if (isinstance(a, str) and isinstance(b, str)) or a is None or b is None:
                    if not isinstance(operator, (ast.Eq, ast.NotEq)):
                        raise self._refused(node, "orders texts or values that are nothing: only == and != are known")
                    return _of_bool((a == b) is isinstance(operator, ast.Eq))
                return _compared(compare, self._number(nodes[index], a), self._number(nodes[index + 1], b))

            return judged

        return _joined([pair(index) for index in range(len(operators))], is_and=True)

    def _truth(self, node: ast.expr, value: Any) -> Verdict:
        if isinstance(value, (bool, np.bool_)):
            return _of_bool(bool(value))
        raise self._refused(node, f"is {quoted(value)}, no condition: compare it, as in 'a > 0.4'")

    # -- values ----------------------------------------------------------------------------

    def _value(self, node: ast.expr) -> _Value:
        match node:
            case ast.Constant(value=bool() | str() as constant):
                return lambda _look: constant
            case ast.Constant(value=int() | float() as number):
                try:
                    constant_number = float(number)
                except OverflowError:
                    raise self._refused(node, "is too great a number") from None
                return lambda _look: constant_number
            case ast.Constant(value=None):
                return lambda _look: None
            case ast.Name() | ast.Attribute():
                parts = self._parts(node)
                self.names.add(parts)
                return lambda look: _as_value(look(parts))
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
                inner, factor = self._value(operand), -1.0 if isinstance(sign, ast.USub) else 1.0
                return lambda look: factor * self._numbers(operand, inner(look))
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
                return self._operation(left, operator, right)
            case ast.Call(func=called, args=arguments, keywords=[]):
                return self._call(node, called, arguments)
            case ast.Subscript(value=inner_node, slice=index):
                return self._item(node, inner_node, index)
        raise self._refused(node, "is not a part of requirements: see docs/falsify.md for what is")

    def _parts(self, node: ast.expr) -> tuple[str, ...]:
        parts: list[str] = []
        while isinstance(node, ast.Attribute):
            parts.append(node.attr)
            node = node.value
        if not isinstance(node, ast.Name):
            raise self._refused(node, "has no attributes here: only names such as robot.pose.x have parts")
        parts.append(node.id)
        for part in parts:
            if part.startswith("_"):
                raise RequirementError(f"in {quoted(self.text)}, {part!r} is not a name of a component or a field")
        return tuple(reversed(parts))

    def _operation(self, left: ast.expr, operator: ast.operator, right: ast.expr) -> _Value:
        if isinstance(operator, ast.Pow):
            is_small = isinstance(right, ast.Constant) and isinstance(right.value, (int, float))
            if not is_small or abs(right.value) > _GREATEST_EXPONENT:  # type: ignore[attr-defined]
                raise self._refused(right, f"is not an exponent: expected a number of at most {_GREATEST_EXPONENT}")
        a, b, function = self._value(left), self._value(right), _OPERATORS[type(operator)]

        def computed(look: Look) -> Any:
            first, second = self._numbers(left, a(look)), self._numbers(right, b(look))
            try:
                with np.errstate(all="ignore"):
                    result = function(first, second)
            except ArithmeticError:
                return math.nan
            except ValueError:
                raise RequirementError(f"in {quoted(self.text)}, two lists have different lengths") from None
            return math.nan if isinstance(result, complex) else result

        return computed

    def _call(self, node: ast.expr, called: ast.expr, arguments: Sequence[ast.expr]) -> _Value:
        if isinstance(called, ast.Attribute) and not arguments and called.attr in _METHODS:
            inner, method = self._value(called.value), _METHODS[called.attr]
            return lambda look: method(self._numbers(called.value, inner(look)))
        if not isinstance(called, ast.Name) or called.id not in _FUNCTIONS:
            is_method = isinstance(called, ast.Attribute)
            name = called.attr if isinstance(called, ast.Attribute) else ast.unparse(called)
            known = [*_METHODS] if is_method else [*_FUNCTIONS]
            raise self._refused(node, f"calls {quoted(name)}, which requirements do not know{nearest(name, known)}")
        count, function = _FUNCTIONS[called.id]
        if len(arguments) != count if count >= 0 else not arguments:
            expected = f"{count} argument{'s' * (count > 1)}" if count > 0 else "at least one argument"
            raise self._refused(node, f"has {len(arguments)} arguments; {called.id} has {expected}")
        values = [self._value(one) for one in arguments]
        if called.id == "len":
            return lambda look: self._counted(arguments[0], values[0](look))
        takes_lists = called.id in ("abs", "min", "max", "sum")

        def call(look: Look) -> Any:
            numbers = [self._numbers(one, value(look)) for one, value in zip(arguments, values, strict=True)]
            if not takes_lists:
                numbers = [self._number(one, value) for one, value in zip(arguments, numbers, strict=True)]
            return function(*numbers)

        return call

    def _counted(self, node: ast.expr, value: Any) -> float:
        if isinstance(value, (str, list, dict, np.ndarray)):
            return float(len(value))
        raise self._refused(node, f"is {quoted(value)}, which has no length")

    def _item(self, node: ast.expr, inner_node: ast.expr, index: ast.expr) -> _Value:
        if isinstance(index, ast.Slice):
            ends = [None if one is None else self._integer(one) for one in (index.lower, index.upper, index.step)]
            key: Any = slice(*ends)
            if key.step == 0:
                raise self._refused(node, "has steps of 0")
        elif isinstance(index, ast.Constant) and isinstance(index.value, str):
            key = index.value
        else:
            key = self._integer(index)
        inner = self._value(inner_node)

        def item(look: Look) -> Any:
            value = inner(look)
            try:
                return _as_value(value[key])
            except (IndexError, KeyError):
                if isinstance(value, dict) or len(value):
                    raise self._refused(node, f"does not exist: there are {len(value)}") from None
                raise NotYetError from None
            except (TypeError, ValueError):
                raise self._refused(node, f"is not part of {quoted(value)}") from None

        return item

    def _integer(self, node: ast.expr) -> int:
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() as value)) if not _is_bool(node):
                return -value
            case ast.Constant(value=int() as value) if not isinstance(value, bool):
                return value
        raise self._refused(node, "is not an index: expected an integer, a slice of integers, or a text")

    def _number(self, node: ast.expr, value: Any) -> float:
        value = self._numbers(node, value)
        if isinstance(value, np.ndarray):
            if value.size != 1:
                raise self._refused(node, f"is a list of {value.size} numbers: use .min(), .max() or an index")
            value = value.item()
        return float(value)

    def _numbers(self, node: ast.expr, value: Any) -> Any:
        if isinstance(value, (bool, float, np.ndarray)):
            return value
        raise self._refused(node, f"is {quoted(value)}, expected a number")

    def _refused(self, node: ast.AST, reason: str) -> RequirementError:
        part = ast.get_source_segment(self.text, node) or self.text
        where = "" if part == self.text else f"in {quoted(self.text)}, "
        return RequirementError(f"{where}{quoted(part)} {reason}")


class Quantity(Expression):
    """A number as text, such as a signal: ``hypot(robot.pose.x - 3, robot.pose.y)``."""

    def _root_of(self, node: ast.expr) -> _Condition:
        value = self._value(node)
        return lambda look: Verdict(True, self._number(node, value(look)))

    def value(self, look: Look) -> float:
        """Return the present value; see `Expression.judge`."""
        return self._root(look).robustness


def _depth(tree: ast.AST) -> int:
    depth, level = 0, [tree]
    while level and depth <= _DEEPEST:
        level = [child for node in level for child in ast.iter_child_nodes(node)]
        depth += 1
    return depth


def _is_bool(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, bool)


def _of_bool(holds: bool) -> Verdict:
    return Verdict(holds, 1.0 if holds else -1.0)


def _opposite(verdict: Verdict) -> Verdict:
    return Verdict(not verdict.holds, -verdict.robustness)


def _compared(compare: Callable[[float, float], Verdict], a: float, b: float) -> Verdict:
    if a == b:  # also both infinite
        return Verdict(compare(0.0, 0.0).holds, 0.0)
    holds, robustness = compare(a, b)
    return Verdict(holds and not math.isnan(robustness), robustness)


def _joined(parts: list[_Condition], *, is_and: bool) -> _Condition:
    if len(parts) == 1:
        return parts[0]

    def judged(look: Look) -> Verdict:
        verdicts = [part(look) for part in parts]
        values = [verdict.robustness for verdict in verdicts]
        if any(map(math.isnan, values)):
            return Verdict(False, math.nan)
        holds = [verdict.holds for verdict in verdicts]
        return Verdict(all(holds), min(values)) if is_and else Verdict(any(holds), max(values))

    return judged


def _as_value(value: Any) -> Any:
    """A value of data, as expressions compute with it: numbers as floats, lists of numbers as arrays."""
    if isinstance(value, (bool, str)) or value is None or isinstance(value, dict):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, np.ndarray):
        return value.astype(float) if value.dtype.kind in "fiub" else value.tolist()
    if isinstance(value, (list, tuple)):
        try:
            return np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            return list(value)
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return value
