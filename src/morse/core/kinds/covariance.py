"""Covariances that are computed from the noise that a script declares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.core.declarations import DataField
    from morse.core.kinds.kind import Kind, Slot
    from morse.core.kinds.sources import Source


def covariances(
    component: object, kind: Kind, sources: Iterable[tuple[Slot, Source]], fields: Mapping[str, DataField]
) -> dict[str, Any]:
    """Return the covariance slots that the component does not fill itself; an empty list if no noise is declared.

    The variance of each axis is the variance of the white noise of its field, in the unit of the slot. The fields are
    uncorrelated. Euler angles are treated as small rotations about X, Y and Z.
    """
    deviations = _deviations(component)
    if not deviations:
        return {}
    by_name = {slot.name: (slot, source) for slot, source in sources}
    result = {}
    for slot in kind.slots.values():
        if slot.covariance_of and slot.name not in by_name:
            matrix = _matrix(slot, by_name, deviations, fields)
            if matrix is not None:
                result[slot.name] = matrix
    return result


def _deviations(component: Any) -> dict[str, float]:
    """Standard deviation of the white noise of each field, in the unit of the field."""
    realism = getattr(component, "realism", None)
    deviations = dict(realism.deviations()) if realism is not None else {}
    modifiers = (getattr(modifier, "changes", {}) for modifier in component.output_modifiers)
    for changes in (component.field_changes, *modifiers):
        for name, change in changes.items():
            if "stddev" in change:
                deviations[name] = (deviations.get(name, 0.0) ** 2 + change["stddev"] ** 2) ** 0.5
    return {name: deviation for name, deviation in deviations.items() if deviation > 0.0}


def _matrix(
    covariance: Slot,
    by_name: Mapping[str, tuple[Slot, Source]],
    deviations: Mapping[str, float],
    fields: Mapping[str, DataField],
) -> Any:
    import numpy as np

    from morse.core.units import conversion

    variances: list[float] = []
    for name in covariance.covariance_of:
        slot, source = by_name.get(name, (None, None))
        if slot is None or source is None or not source.fields:
            variances += [0.0, 0.0, 0.0]
            continue
        axes = source.fields if len(source.fields) == 3 else source.fields * 3
        unit = slot.unit or "rad"
        for field in axes:
            deviation = 0.0 if field is None else deviations.get(field, 0.0)
            if deviation and field is not None and fields[field].unit:
                deviation *= conversion(fields[field].unit, unit)[0]
            variances.append(deviation * deviation)
    if not any(variances):
        return None
    matrix = np.diag(variances)
    matrix.flags.writeable = False
    return matrix
