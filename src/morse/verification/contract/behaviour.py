"""Rules for the undisturbed behaviour of a component."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

from morse.core.declarations import fields_of_component
from morse.core.state import StateError
from morse.core.validation.published import misfits
from morse.verification.contract.report import Fault

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.verification.contract.contract_world import ContractWorld
    from morse.verification.contract.log_capture import LogCapture

FITS, JSON, DETERMINISTIC = "data fit their declarations", "data are JSON", "deterministic under a seed"
SAVED, RESET = "saved and restored", "a reset makes it new"

#: ticks of a run: long enough for components that act once per second
TICKS = 70
_BEFORE_SAVING = 25


def well_behaved(stand: ContractWorld, other: Callable[[], ContractWorld], journal: LogCapture) -> Iterator[Fault]:
    """All rules of this file.

    Args:
        stand: a simulation after the launch.
        other: creates another one.
    """
    cls = type(stand.component)
    place = stand.places.of_class(cls)
    try:
        first = stand.run(TICKS)
    except (TypeError, ValueError) as error:
        yield Fault(JSON, f"{error}: keep numbers, words, lists and dictionaries in local_data", place)
        return
    if stand.failed:
        yield Fault(FITS, f"it fails when it acts: {journal.last('no reason is given')}", place)
        return
    yield from _fits(stand)
    yield from _is_json(stand, first)
    with other() as again:
        yield from _same(
            DETERMINISTIC, first, again.run(TICKS), place, "take random numbers from self.context.random()"
        )
    try:
        yield from _saved(stand, other, place)
    except StateError as error:
        yield Fault(SAVED, str(error), place)
    stand.simulation.restart(seed=1)
    hint = "keep what changes in the component, not in its class or module"
    yield from _same(RESET, first, stand.run(TICKS), place, hint)


def _fits(stand: ContractWorld) -> Iterator[Fault]:
    """Check that the data match the declarations."""
    places, cls = stand.places, type(stand.component)
    for field, declaration, text in misfits(stand.component):
        yield Fault(FITS, text, places.of(cls, "add_data", field) if declaration else places.of_class(cls))


def _is_json(stand: ContractWorld, lines: list[bytes]) -> Iterator[Fault]:
    cls = type(stand.component)
    fields = fields_of_component(stand.component)
    values: dict[str, float] = {}
    for line in lines:
        for name, value in json.loads(line).items():
            allow = fields[name].allow if name in fields else ()
            for number in _numbers(value):
                if not math.isfinite(number) and str(number) not in allow:
                    values.setdefault(name, number)
    for name, number in values.items():
        text = f"the data field '{name}' was {number}, which is not JSON: declare it by allow=('{number}',) or avoid it"
        yield Fault(JSON, text, stand.places.of(cls, "add_data", name))


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, (list, dict)):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _numbers(item)


def _same(rule: str, one: list[bytes], other: list[bytes], place: str, hint: str) -> Iterator[Fault]:
    for tick, (a, b) in enumerate(zip(one, other, strict=True), 1):
        if a != b:
            names = [name for name, value in json.loads(a).items() if repr(value) != repr(json.loads(b).get(name))]
            what = ", ".join(f"'{name}'" for name in names) or "the order of its data"
            yield Fault(rule, f"two runs differ first in tick {tick}, in {what}: {hint}", place)
            return


def _saved(stand: ContractWorld, other: Callable[[], ContractWorld], place: str) -> Iterator[Fault]:
    simulation = stand.simulation
    simulation.restart(seed=1)
    stand.run(_BEFORE_SAVING)
    state = simulation.save()
    for text in state.unsaved:
        yield Fault(SAVED, f"{text} cannot be saved: keep plain data, or write get_state() and set_state()", place)
    with other() as fresh:
        fresh.simulation.restore(type(state).from_bytes(state.to_bytes()))
        ahead = stand.run(TICKS - _BEFORE_SAVING), simulation.save().fingerprints()
        again = fresh.run(TICKS - _BEFORE_SAVING), fresh.simulation.save().fingerprints()
    yield from _same(SAVED, ahead[0], again[0], place, "a part of its state is not in its attributes")
    if ahead[0] == again[0]:
        parts = [name for name, value in ahead[1].items() if value != again[1].get(name)]
        if parts:
            yield Fault(SAVED, f"after the same ticks the states differ in {', '.join(parts)}", place)
