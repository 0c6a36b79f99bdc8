"""What has to hold in a run, and the observer that judges it in each tick."""

from __future__ import annotations

import inspect
import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from morse.core.observer import Observer
from morse.core.reports.quoting import nearest, quoted
from morse.plugins.falsify.expressions import FAR, Expression, NotYetError, Quantity, RequirementError, Verdict
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse import Simulation

#: the column of the results with what each requirement was
VERDICTS = "requirements"
#: the column with the texts that a run returns: failures with different texts are of different kinds
KIND = "kind"
#: longest text of a result that tells kinds of failures apart, and of all of them
LONGEST_TEXT, LONGEST_KIND = 80, 400
#: largest size of the results of a run as JSON, characters: a search keeps those of thousands of runs
LARGEST_RESULT = 1 << 16
#: how a requirement is judged
ALWAYS, EVENTUALLY, SIGNALS = "always", "eventually", "signals"
#: names of what each run has, besides its parameters and results
_TIME = "time"
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_WORDS = frozenset(
    (
        "always", "eventually", "historically", "once", "until", "since", "next", "prev", "rise", "fall", "not", "and",
        "or", "xor", "implies", "iff", "abs", "sqrt", "exp", "pow", "G", "F", "H", "O", "U", "S", "X", "Y", "s", "ms",
        "us", "ns", "ps", "W", "unless", "release", "true", "false",
    )
)  # fmt: skip


@dataclass(frozen=True)
class Requirement:
    """Something that has to hold.

    Attributes:
        name: what results, reports and tests call it.
        mode: `ALWAYS`: in each tick; `EVENTUALLY`: in one tick at least; `SIGNALS`: a formula of temporal logic.
        condition: an expression, a formula, or a function.
        within: simulated time until which it has to hold once, s; infinite for the whole run.
        where: file and line of the script.
        of_results: whether it is judged once, at the end.
    """

    name: str
    mode: str
    condition: str | Callable[..., object]
    within: float = math.inf
    where: str = ""
    of_results: bool = False
    expression: Expression | None = field(default=None, compare=False, repr=False)


def requirement(
    mode: str, condition: object, parameters: tuple[str, ...], *, within: float, name: str | None, where: str
) -> Requirement:
    """Check a requirement.

    Args:
        parameters: the names of the parameters of the scenario, which are not results.

    Raises:
        RequirementError: it is not a condition; the message contains the line.
        TypeError: it is neither a text nor a function.
    """
    if not within > 0.0:
        raise ValueError(f"within is a time in seconds, greater than 0, not {within!r:.80}")
    if callable(condition):
        title = name or str(getattr(condition, "__name__", type(condition).__name__))
        of_results = list(inspect.signature(condition).parameters)[:1] == ["results"]
        return Requirement(title, mode, condition, within, where, of_results)
    if not isinstance(condition, str):
        raise TypeError(f"a requirement is a text or a function, not {condition!r:.80}")
    suffix = f" within {within:g} s" if within < math.inf else ""
    title = name or (condition.strip() if mode != EVENTUALLY else f"eventually {condition.strip()}{suffix}")
    if mode == SIGNALS:
        return Requirement(title, mode, condition, within, where)
    try:
        expression = Expression(condition)
    except RequirementError as error:
        raise RequirementError(f"{where}: {error}") from None
    of_ticks = sorted(".".join(parts) for parts in expression.names if len(parts) > 1 or parts == (_TIME,))
    others = {parts[0] for parts in expression.names if len(parts) == 1}
    results = sorted(others.difference(parameters, (_TIME,)))
    if of_ticks and results:
        raise RequirementError(
            f"{where}: {quoted(condition)} mixes {of_ticks[0]}, which has a value in each tick, with the result "
            f"'{results[0]}' of a whole run: make two requirements, or let the run return both"
        )
    return Requirement(title, mode, condition, within, where, bool(results), expression)


def violations(row: Mapping[str, Any]) -> list[str]:
    """Say what a run violates, a line each; an empty list if it violates nothing."""
    if row["error"]:
        return [f"{row['error']} {row['where']}".strip()]
    lines = []
    for name, (holds, robustness, time) in row[VERDICTS].items():
        if not holds:
            extent = "it is not a number" if robustness is None else f"by {-robustness:.4g}"
            when = "" if time is None else f" at {time:.2f} s"
            lines.append(f"{name}: violated{when}, {extent}")
    return lines


class Names:
    """The present values of names in expressions: fields of components, signals, parameters, the time.

    Args:
        signals: expressions or functions by name.
        parameters: the parameters of the run.
    """

    def __init__(
        self,
        simulation: Simulation,
        signals: Mapping[str, Quantity | Callable[..., object]],
        parameters: Mapping[str, object],
    ) -> None:
        self._simulation, self._signals, self._parameters = simulation, signals, parameters
        self._components: dict[tuple[str, ...], Callable[[], Any]] = {}
        self._kept: dict[tuple[str, ...], Any] = {}

    def look(self, parts: tuple[str, ...]) -> Any:
        """Return the present value of a name: a field of a component, a signal, a parameter, or the time."""
        if parts not in self._kept:
            if parts not in self._components:
                self._components[parts] = self._source(parts)
            self._kept[parts] = self._components[parts]()
        return self._kept[parts]

    def forget(self) -> None:
        """Read all values anew: another tick begins."""
        self._kept.clear()

    def _source(self, parts: tuple[str, ...]) -> Callable[[], Any]:
        name = ".".join(parts)
        if parts == (_TIME,):
            return self._simulation.time
        if len(parts) == 1:
            if name in self._signals:
                signal = self._signals[name]
                return lambda: _signal_value(signal, self._simulation, self.look)
            if name in self._parameters:
                return lambda: self._parameters[name]
            raise RequirementError(f"there is no '{name}'{nearest(name, [*self._signals, *self._parameters])}")
        robots = list(self._simulation.robots)
        if parts[0] not in robots:
            raise RequirementError(f"'{name}': the scene has no robot '{parts[0]}'{nearest(parts[0], robots)}")
        handle, rest = self._simulation[parts[0]], list(parts[1:])
        while rest and rest[0] in handle.parts:
            handle = handle.parts[rest.pop(0)]
        data = handle.data
        if not rest:
            raise RequirementError(f"'{name}' is a component: name one of its fields{nearest('', list(data))}")
        if rest[0] not in data:
            known = [*handle.parts, *data]
            raise RequirementError(f"'{name}': {handle.fqn} has no '{rest[0]}'{nearest(rest[0], known)}")

        def value() -> Any:
            found: Any = handle.data[rest[0]]
            for key in rest[1:]:
                if not isinstance(found, dict) or key not in found:
                    known = list(found) if isinstance(found, dict) else []
                    raise RequirementError(f"'{name}': there is no '{key}' in {rest[0]}{nearest(key, known)}")
                found = found[key]
            return found

        return value


class Monitor(Observer):
    """Judges the requirements of a run in each tick.

    Args:
        signals: expressions or functions by name, for formulas of temporal logic and for expressions.
        parameters: the parameters of the run.
    """

    def __init__(
        self,
        simulation: Simulation,
        requirements: list[Requirement],
        signals: Mapping[str, Quantity | Callable[..., object]],
        parameters: Mapping[str, object],
    ) -> None:
        self._simulation, self._parameters = simulation, parameters
        self._names = Names(simulation, signals, parameters)
        self._requirements = requirements
        self._in_ticks = [one for one in requirements if not one.of_results and one.mode != SIGNALS]
        self._formulas = [Formula(one, signals) for one in requirements if one.mode == SIGNALS]
        self._worst: dict[str, tuple[bool, float, float | None]] = {}
        self._tick = -1

    def after_tick(self) -> None:
        """Judge the present tick."""
        if self._simulation.ticks == self._tick:
            return
        self._tick = self._simulation.ticks
        self._names.forget()
        time = self._simulation.time()
        for one in self._in_ticks:
            verdict = self._judge(one)
            if verdict is not None:
                self._note(one, verdict, time)
        for formula in self._formulas:
            formula.note(time, self._names.look)

    def _judge(self, one: Requirement) -> Verdict | None:
        try:
            if one.expression is not None:
                return one.expression.judge(self._names.look)
            assert callable(one.condition)
            return _verdict_of(one, one.condition(self._simulation))
        except NotYetError:
            return None
        except RequirementError as error:
            raise RequirementError(f"{one.where}: {error}") from None

    def _note(self, one: Requirement, verdict: Verdict, time: float) -> None:
        if one.mode == EVENTUALLY and time > one.within + 1e-9:
            return
        holds, robustness = verdict
        before = self._worst.get(one.name)
        if before is None:
            self._worst[one.name] = (holds, robustness, time)
            return
        is_worse = math.isnan(robustness) or (robustness < before[1] and not math.isnan(before[1]))
        if one.mode == ALWAYS:
            # the time is that of the first violation
            moment = before[2] if not before[0] or (holds and not is_worse) else time
            self._worst[one.name] = (before[0] and holds, robustness if is_worse else before[1], moment)
        elif not before[0] and (holds or robustness > before[1] or math.isnan(before[1])):
            self._worst[one.name] = (holds, robustness, time)

    def verdicts(self, results: dict[str, Any]) -> dict[str, list[Any]]:
        """Judge the run as a whole.

        Args:
            results: what its function has returned.

        Returns:
            For each requirement whether it holds, its robustness (None if it is not a number), and the simulated
            time, s (None if it was judged at the end).

        Raises:
            RequirementError: a requirement names something that does not exist.
        """
        time = self._simulation.time()
        for formula in self._formulas:
            self._worst[formula.requirement.name] = (*formula.judge(results), None)
        for one in self._requirements:
            if one.of_results:
                self._worst[one.name] = (*self._of_results(one, results), None)
            elif one.name not in self._worst:
                # no tick has passed, or its sensors have never measured
                self._worst[one.name] = (False, math.nan, time)
        return {
            name: [holds, None if math.isnan(robustness) else robustness, moment]
            for name, (holds, robustness, moment) in self._worst.items()
        }

    def _of_results(self, one: Requirement, results: dict[str, Any]) -> Verdict:
        if one.expression is None:
            assert callable(one.condition)
            return _verdict_of(one, one.condition(results))

        def look(parts: tuple[str, ...]) -> Any:
            if parts[0] in self._parameters:
                return self._parameters[parts[0]]
            if parts[0] not in results:
                known = nearest(parts[0], [*results, *self._parameters])
                raise RequirementError(f"the run returns no '{parts[0]}'{known}")
            return results[parts[0]]

        try:
            return one.expression.judge(look)
        except NotYetError:
            return Verdict(False, math.nan)
        except RequirementError as error:
            raise RequirementError(f"{one.where}: {error}") from None


def _verdict_of(one: Requirement, returned: object) -> Verdict:
    """What a function of the user has returned: a condition, or its robustness."""
    if isinstance(returned, bool) or type(returned).__name__ == "bool_":
        return Verdict(bool(returned), 1.0 if returned else -1.0)
    try:
        robustness = float(returned)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise RequirementError(
            f"{one.where}: {one.name} returned {quoted(returned)}, expected True, False, or how far it is from being "
            "violated, a number"
        ) from None
    if math.isnan(robustness):
        return Verdict(False, math.nan)
    return Verdict(robustness >= 0.0, max(-FAR, min(FAR, robustness)))


def _signal_value(signal: Any, simulation: Simulation, look: Any) -> float:
    return signal.value(look) if isinstance(signal, Quantity) else float(signal(simulation))


class Formula:
    """A formula of signal temporal logic, judged by rtamt at the end of a run.

    Names with dots are fields of components in each tick, names without are signals of the scenario, or results that
    have a number for each tick.

    Raises:
        ImportError: rtamt is not installed.
        RequirementError: rtamt refuses the formula.
    """

    def __init__(self, one: Requirement, signals: Mapping[str, object]) -> None:
        assert isinstance(one.condition, str)
        self.requirement, self._text = one, one.condition
        names = dict.fromkeys(name for name in _IDENTIFIER.findall(self._text) if name not in _WORDS)
        self._known = {name: tuple(name.split(".")) for name in names if "." in name or name in signals}
        self._results = [name for name in names if name not in self._known]
        self._variables = {name: f"v{number}" for number, name in enumerate(names)}
        self._values: dict[str, list[list[float]]] = {name: [] for name in names}
        self._times: list[float] = []

    def note(self, time: float, look: Callable[[tuple[str, ...]], Any]) -> None:
        """Keep the values of a tick."""
        self._times.append(time)
        for name, parts in self._known.items():
            try:
                self._values[name].append([time, float(look(parts))])
            except NotYetError:
                continue
            except (TypeError, ValueError):
                raise RequirementError(f"{self.requirement.where}: '{name}' is not a number") from None
            except RequirementError as error:
                raise RequirementError(f"{self.requirement.where}: {error}") from None

    def judge(self, results: Mapping[str, Any]) -> Verdict:
        """Return the verdict at the beginning of the run.

        Args:
            results: what the function of the run has returned.
        """
        for name in self._results:
            if name not in results:
                hint = nearest(name, [*results, *self._known])
                raise RequirementError(f"{self.requirement.where}: there is no signal and no result '{name}'{hint}")
            values = results[name]
            if not isinstance(values, list) or len(values) != len(self._times):
                raise RequirementError(
                    f"{self.requirement.where}: the result '{name}' is not a list of {len(self._times)} numbers, one "
                    "for each tick"
                )
            self._values[name] = [[time, float(value)] for time, value in zip(self._times, values, strict=True)]
        if not self._times or not all(self._values.values()):
            return Verdict(False, math.nan)
        robustness = self._evaluated()
        return Verdict(robustness >= 0.0, max(-FAR, min(FAR, robustness)))

    def _evaluated(self) -> float:
        try:
            import rtamt
        except ImportError:
            raise RequirementError(
                f"{self.requirement.where}: formulas of temporal logic need rtamt: {install('falsify')}"
            ) from None
        specification = rtamt.StlDenseTimeSpecification()
        for variable in self._variables.values():
            specification.declare_var(variable, "float")
        specification.spec = _IDENTIFIER.sub(lambda found: self._variables.get(found[0], found[0]), self._text)
        try:
            specification.parse()
            values = specification.evaluate(*([self._variables[name], self._values[name]] for name in self._variables))
        except Exception as error:
            raise RequirementError(f"{self.requirement.where}: rtamt refuses {quoted(self._text)}: {error}") from None
        return float(values[0][1]) if values else math.nan
