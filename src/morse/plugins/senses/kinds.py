"""The message kinds of these senses (entry point ``morse.kinds``)."""

from morse.core.kinds import Kind, Slot


def _kind(name: str, doc: str, *slots: Slot) -> Kind:
    return Kind(name, {slot.name: slot for slot in slots}, True, False, 1, doc)


KINDS = (
    _kind(
        "radar_returns",
        "Detections of a radar.",
        Slot(
            "records",
            (None,),
            "object",
            doc="dictionaries with range (m), azimuth and elevation (rad), velocity (m/s, positive: it moves away) and "
            "rcs (m²)",
        ),
    ),
    _kind(
        "doppler_log",
        "Velocity over the ground, or relative to the water, by Doppler shifts along beams.",
        Slot("velocity", (3,), unit="m/s", frame="own", moves="vector", doc="NaN without lock"),
        Slot("altitude", unit="m", doc="vertical distance of the ground; infinite without a bottom"),
        Slot("locked", (), "bool"),
        Slot("reference", (), "str", choices=("bottom", "water", "none")),
        Slot("beams", (None, 3), frame="own", doc="unit vectors"),
        Slot("ranges", (None,), unit="m", doc="along the beams; infinite without an echo"),
        Slot("beam_velocities", (None,), unit="m/s", doc="along the beams, positive towards the ground"),
        Slot("sound_speed", unit="m/s"),
    ),
    _kind(
        "sonar_image",
        "Echoes by range and beam.",
        Slot("pixels", (None, None), "uint8", doc="a row for each range, the nearest first; a column for each beam"),
        Slot("azimuths", (None,), unit="rad", doc="of the beams, positive to the left"),
        Slot("ranges", (None,), unit="m", doc="of the rows"),
        Slot("frequency", unit="Hz"),
        Slot("sound_speed", unit="m/s"),
    ),
    _kind(
        "events",
        "Pixels whose brightness has changed.",
        Slot("events", (None, 4), doc="column, row, time (s) and polarity (1 or -1), in the order of time"),
        Slot("width", unit="px"),
        Slot("height", unit="px"),
    ),
)
