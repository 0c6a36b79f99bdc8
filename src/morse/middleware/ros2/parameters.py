"""The parameters of the node: the properties of components, typed, and ``use_sim_time``.

A parameter is ``<component>.<property>``, such as ``robot.motion.ControlType``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.declarations.fields import PropertyTable
from morse.core.reports.quoting import nearest, shown
from morse.core.validation import checked_property
from morse.core.validation.spec import PropertyError
from morse.middleware.ros2 import NODE
from morse.middleware.ros2.domain import Served
from morse.rosmsgs.parts import as_json, from_json
from morse.rosmsgs.services import VALUES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.context import Context
    from morse.core.declarations import Property
    from morse.core.request_manager import Outcome
    from morse.core.values import DecodedMessage, RosMessage
    from morse.middleware.ros2.domain import Reply
    from morse.rosmsgs.topics.backend import Backend

#: constants of rcl_interfaces/ParameterType
_NOT_SET, _BOOL, _INTEGER, _DOUBLE, _STRING = 0, 1, 2, 3, 4
_OF_LISTS = {bool: 6, int: 7, float: 8, str: 9}
_BY_WORD = {"bool": _BOOL, "int": _INTEGER, "float": _DOUBLE, "double": _DOUBLE, "string": _STRING, "str": _STRING}
_WORDS = {0: "nothing", 1: "bool", 2: "integer", 3: "double", 4: "string"}
_TIME = "use_sim_time"
#: maximum number of parameters that a request sets: a tick waits for it
MOST = 64
_TOO_MANY = f"a request sets up to {MOST} parameters"


class _Parameter:
    """A parameter: a property of a component, or ``use_sim_time`` without one."""

    def __init__(self, component: Any = None, attribute: str = "", declaration: Property | None = None) -> None:
        self.component, self._attribute, self.declaration = component, attribute, declaration

    @property
    def present(self) -> Any:
        return getattr(self.component, self._attribute) if self.declaration is not None else True

    @property
    def type(self) -> int:
        """Of the declaration; a list by its items, and JSON text for all others."""
        value, declaration = self.present, self.declaration
        word = "bool" if declaration is None else declaration.type
        if word in _BY_WORD and not isinstance(value, (list, tuple, dict)):
            return _BY_WORD[word]
        if isinstance(value, (list, tuple)) and value:
            kinds = {type(item) for item in value}
            kind = float if kinds == {int, float} else kinds.pop() if len(kinds) == 1 else None
            return _OF_LISTS.get(kind, _STRING) if kind is not None else _STRING
        return next((kind for cls, kind in ((bool, 1), (int, 2), (float, 3)) if isinstance(value, cls)), _STRING)

    def value(self) -> RosMessage:
        """``rcl_interfaces/ParameterValue``; none for a number or a text that is not set."""
        kind, value = self.type, self.present
        if value is None:
            return {"type": _NOT_SET}
        if kind == _DOUBLE:
            value = float(value)
        elif kind == _OF_LISTS[float]:
            value = [float(item) for item in value]
        elif kind > _STRING:
            value = list(value)
        elif kind == _STRING and not isinstance(value, str):
            value = as_json(value)
        return {"type": kind, VALUES[kind]: value}

    def taken(self, value: DecodedMessage) -> Any:
        """The value of a message.

        Raises:
            PropertyError: it has another type.
        """
        kind = value["type"]
        content: Any = value[VALUES[kind]] if kind in VALUES else None
        content = content.tolist() if hasattr(content, "tolist") else content
        if kind == self.type or (kind, self.type) in ((_INTEGER, _DOUBLE), (7, 8)):
            return from_json(content) if kind == _STRING and not isinstance(self.present, str) else content
        names = [_WORDS.get(one, "list") for one in (kind, self.type)]
        raise PropertyError(f"the value is a {names[0]}, expected a {names[1]}")

    def descriptor(self, name: str) -> RosMessage:
        """``rcl_interfaces/ParameterDescriptor``."""
        one = self.declaration
        if one is None:
            text = "Always true: the stamps of all messages are simulated time"
            return {"name": name, "type": _BOOL, "description": text, "read_only": True}
        words = [one.doc, f"unit: {one.unit}" if one.unit else ""]
        bounds = [f"{sign} {limit:g}" for sign, limit in ((">=", one.low), ("<=", one.high)) if limit is not None]
        limits = ["one of " + ", ".join(map(str, one.choices))] if one.choices else bounds
        entry = {"description": "; ".join(filter(None, words)), "additional_constraints": " and ".join(limits)}
        ranges: RosMessage = {}
        if one.low is not None and one.high is not None and self.type in (_INTEGER, _DOUBLE) and not one.allow:
            cast, key = (int, "integer_range") if self.type == _INTEGER else (float, "floating_point_range")
            ranges[key] = [{"from_value": cast(one.low), "to_value": cast(one.high)}]
        return {"name": name, "type": self.type, "read_only": False, **entry, **ranges}


class Parameters(Served):
    """Answers the parameter services of a node.

    Args:
        context: of the simulation.
        backend: a backend with services.
        components: returns the names of the components whose properties may be set.
        call: calls a service of MORSE: component, service, arguments, and a callback for the outcome.
    """

    def __init__(
        self, context: Context, backend: Backend, components: Callable[[], Iterable[str]], call: Callable[..., object]
    ) -> None:
        self._properties, self._call = PropertyTable(context.component, components), call
        handlers = {
            "get_parameters": ("GetParameters", self._get),
            "get_parameter_types": ("GetParameterTypes", self._types),
            "set_parameters": ("SetParameters", self._set),
            "set_parameters_atomically": ("SetParametersAtomically", self._set_together),
            "describe_parameters": ("DescribeParameters", self._describe),
            "list_parameters": ("ListParameters", self._list),
        }
        kinds = {f"/{NODE}/{name}": (f"rcl_interfaces/srv/{kind}", one) for name, (kind, one) in handlers.items()}
        super().__init__(backend, kinds)

    def _names(self) -> list[str]:
        return [_TIME, *self._properties.names()]

    def _parameter(self, name: str) -> _Parameter | None:
        if name == _TIME:
            return _Parameter()
        one = self._properties.find(name)
        return None if one is None else _Parameter(*one)

    def _several(self, names: Iterable[str]) -> list[_Parameter | None]:
        """The parameters of names, each of which is searched once: a client may send any number."""
        table = {name: self._parameter(name) for name in set(names)}
        return [table[name] for name in names]

    def _get(self, request: DecodedMessage, reply: Reply) -> None:
        parameters = self._several(request["names"])
        reply({"values": [{"type": _NOT_SET} if one is None else one.value() for one in parameters]})

    def _types(self, request: DecodedMessage, reply: Reply) -> None:
        parameters = self._several(request["names"])
        reply({"types": [_NOT_SET if one is None else one.type for one in parameters]})

    def _describe(self, request: DecodedMessage, reply: Reply) -> None:
        pairs = list(zip(request["names"], self._several(request["names"]), strict=True))
        reply({"descriptors": [{"name": n, "type": _NOT_SET} if p is None else p.descriptor(n) for n, p in pairs]})

    def _list(self, request: DecodedMessage, reply: Reply) -> None:
        prefixes, depth = list(request["prefixes"]), request["depth"]
        names = []
        for name in self._names():
            inside = [p for p in prefixes if name == p or name.startswith(f"{p}.")] if prefixes else [""]
            rests = [name.removeprefix(prefix).lstrip(".") for prefix in inside]
            if rests and (not depth or min(rest.count(".") for rest in rests) < depth):
                names.append(name)
        parents = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
        reply({"result": {"names": names, "prefixes": list(parents)}})

    # -- setting -----------------------------------------------------------------------------

    def _checked(self, entry: DecodedMessage) -> tuple[str, str, object] | str:
        """Component, property and value; or why a parameter is refused."""
        name = entry["name"]
        one = self._parameter(name)
        if one is None:
            return f"there is no parameter {shown(name)}{nearest(name, self._names())}"
        if one.declaration is None:
            fits = entry["value"]["type"] == _BOOL and entry["value"]["bool_value"]
            return "" if fits else f"{_TIME} is always true: the clock of this node is that of the simulation"
        try:
            value = one.taken(entry["value"])
            checked_property(one.component, one.declaration.name, value)
        except (PropertyError, ValueError) as error:
            return f"{name}: {error}"
        return one.component.name(), one.declaration.name, value

    def _done(self, change: tuple[str, str, object] | str) -> RosMessage:
        if isinstance(change, str):
            return {"successful": not change, "reason": change}
        component, name, value = change
        outcomes: list[Outcome] = []
        self._call(component, "set_property", [name, value], outcomes.append)
        state, text = outcomes[0] if outcomes else (status.SUCCESS, None)
        good = state == status.SUCCESS
        return {"successful": good, "reason": "" if good else str(text or state)}

    def _set(self, request: DecodedMessage, reply: Reply) -> None:
        parameters = request["parameters"]
        results = [self._done(self._checked(entry)) for entry in parameters[:MOST]]
        reply({"results": results + [{"successful": False, "reason": _TOO_MANY}] * (len(parameters) - len(results))})

    def _set_together(self, request: DecodedMessage, reply: Reply) -> None:
        parameters = request["parameters"]
        if len(parameters) > MOST:
            reply({"result": {"successful": False, "reason": _TOO_MANY}})
            return
        changes = [self._checked(entry) for entry in parameters]
        wrong = [change for change in changes if isinstance(change, str) and change]
        results = [{"successful": False, "reason": wrong[0]}] if wrong else [self._done(change) for change in changes]
        bad = [result for result in results if not result["successful"]]
        reply({"result": bad[0] if bad else {"successful": True, "reason": ""}})
