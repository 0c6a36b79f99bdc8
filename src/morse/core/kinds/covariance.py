"""Covariances that are computed from the noise that a script declares."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from morse.core.kinds.sources import Source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy import float64
    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.core.kinds.sources import DataOwner
    from morse.core.kinds.table import Kind, Slot
    from morse.core.object import Object
    from morse.core.values import Fields, Value

_NOTHING = (0.0, 0.0, 0.0)


class Growing(Source):
    """A covariance that depends on the time, or on the measurements of a modifier.

    Args:
        constant: the part of the white noise.
        per_second: the part of a random walk after one second.
        start: time of the first measurement, s.
        functions: each returns a part at present, or None.
    """

    def __init__(
        self,
        constant: NDArray[float64],
        per_second: NDArray[float64],
        start: float,
        functions: Sequence[Callable[[], NDArray[float64] | None]],
    ) -> None:
        self._constant, self._per_second, self._start, self._functions = constant, per_second, start, functions

    def get(self, component: DataOwner) -> Value:
        """The covariance at the time of the measurement; None if no noise has had an effect."""
        time = component.local_data.get("timestamp", self._start)
        value = self._constant + self._per_second * max(0.0, time - self._start)
        for function in self._functions:
            part = function()
            if part is not None:
                value = value + part
        return value if value.any() else None


class _Spread(NamedTuple):
    """Variances along the axes of a field, in the square of its unit.

    Attributes:
        white: of the white noise.
        walk: of the random walk after one second.
    """

    white: tuple[float, ...] = _NOTHING
    walk: tuple[float, ...] = _NOTHING


_EXACT = _Spread()


def covariances(
    component: Object, kind: Kind, sources: Iterable[tuple[Slot, Source]], fields: Mapping[str, DataField]
) -> tuple[Fields, list[tuple[Slot, Source]]]:
    """Return the covariance slots that the component does not fill itself; none if no noise is declared.

    The variance of each axis is the variance of the noise of its field, in the unit of the slot. The fields are
    uncorrelated, unless a modifier has `AbstractModifier.covariances`. Euler angles are treated as small rotations
    about X, Y and Z.

    Returns:
        The constant ones by name, and the sources of those that change.
    """
    spreads = _spreads(component)
    modifiers = [getattr(modifier, "covariances", {}) for modifier in component.output_modifiers]
    if not spreads and not any(modifiers):
        return {}, []
    realism = getattr(component, "realism", None)
    by_name = {slot.name: (slot, source) for slot, source in sources}
    constant: Fields = {}
    changing: list[tuple[Slot, Source]] = []
    for slot in kind.slots.values():
        if not slot.covariance_of or slot.name in by_name:
            continue
        white, walk = (_matrix(slot, by_name, spreads, fields, part) for part in ("white", "walk"))
        functions = [by_slot[slot.name] for by_slot in modifiers if slot.name in by_slot]
        if walk.any() or functions:
            changing.append((slot, Growing(white, walk, getattr(realism, "start", 0.0), functions)))
        elif white.any():
            if slot.shape:
                white.flags.writeable = False
            constant[slot.name] = white if slot.shape else float(white)
    return constant, changing


def _spreads(component: Object) -> dict[str, _Spread]:
    realism = getattr(component, "realism", None)
    change_list = [realism.changes()] if realism is not None else []
    change_list += [component.field_changes]
    change_list += [getattr(modifier, "changes", {}) for modifier in component.output_modifiers]
    spreads: dict[str, _Spread] = {}
    for changes in change_list:
        for name, change in changes.items():
            spread = spreads.get(name, _EXACT)
            parts = [_sum(a, change.get(key, 0.0)) for a, key in zip(spread, ("stddev", "walk"), strict=True)]
            if any(any(part) for part in parts):
                spreads[name] = _Spread(*parts)
    return spreads


def _sum(variances: Sequence[float], deviation: float | Sequence[float]) -> tuple[float, ...]:
    """Add the variances of a noise, given by one standard deviation, or one for each axis."""
    axes = [deviation] * 3 if isinstance(deviation, (int, float)) else deviation
    return tuple(variance + axis * axis for variance, axis in zip(variances, axes, strict=True))


def _matrix(
    covariance: Slot,
    by_name: Mapping[str, tuple[Slot, Source]],
    spreads: Mapping[str, _Spread],
    fields: Mapping[str, DataField],
    part: str,
) -> Value:
    import numpy as np

    variances: list[float] = []
    for name in covariance.covariance_of:
        slot, source = by_name.get(name, (None, None))
        axes: tuple[str | None, ...] = source.axes if source is not None else ()
        numbers = [(field, axis) for axis, field in enumerate(axes)]
        if len(axes) == 1 and covariance.shape:
            numbers = [(axes[0], axis) for axis in range(3)]
        elif not axes:
            numbers = [(None, axis) for axis in range(3 if covariance.shape else 1)]
        for field, axis in numbers:
            variance = 0.0 if field is None else getattr(spreads.get(field, _EXACT), part)[axis]
            variances.append(variance * _factor(slot, field, fields) ** 2 if variance else 0.0)
    return np.diag(variances) if covariance.shape else np.float64(variances[0])


def _factor(slot: Slot | None, field: str | None, fields: Mapping[str, DataField]) -> float:
    """The factor from the unit of a field to that of a slot."""
    from morse.core.units import conversion

    unit = fields[field].unit if field is not None else ""
    return float(conversion(unit, slot.unit or "rad")[0]) if unit and slot is not None else 1.0
