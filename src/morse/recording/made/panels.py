"""Components whose class belongs to a project: a recorded run is shown without it, by the description of its panel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.declarations import DataField
from morse.core.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.values import Fields
    from morse.recording.made.form import PanelForm

#: property of a node with the panel of its component
PANEL = "recorded panel"


class _Recorded:
    """Has the fields that the recording describes, and does nothing."""

    def __init__(self, obj: Any, parent: object = None) -> None:
        panel: PanelForm = obj.node.properties[PANEL]
        self._fields = {
            one.name: DataField(one.value, one.type, one.doc, unit=one.unit, low=one.low, high=one.high)
            for one in panel.fields
        }
        super().__init__(obj, parent)  # type: ignore[call-arg]
        self._name, self._short_desc = panel.title, panel.doc
        self.local_data: Fields
        for name, field in self._fields.items():
            self.local_data.setdefault(name, field.default)

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """The described fields."""
        return self._fields

    def default_action(self) -> None:
        """Do nothing."""


class RecordedSensor(_Recorded, Sensor):
    """A sensor of a project."""


class RecordedActuator(_Recorded, Actuator):
    """An actuator of a project."""


#: class path for a panel by the class of MORSE that is the only one left
STAND_INS = {
    f"{base.__module__}.{base.__qualname__}": f"{cls.__module__}.{cls.__qualname__}"
    for base, cls in ((Sensor, RecordedSensor), (Actuator, RecordedActuator))
}
