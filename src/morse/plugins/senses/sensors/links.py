"""Radios and acoustic modems: links between robots with loss, delay and collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.senses.sensors.positioning import free_space
from morse.plugins.senses.sources import Source, walls
from morse.plugins.senses.water import absorption, sound_speed, transmission_loss

if TYPE_CHECKING:
    from collections.abc import Iterator

#: longest text of a packet, bytes; header of a packet, bytes; packets that are kept
_LONGEST, _HEADER, _MOST = 1000, 16, 64


class _Packet(NamedTuple):
    """A packet on its way to a receiver.

    Attributes:
        sender: name of the radio that has sent it.
        begin, end: times at which it arrives, s.
        strength: at the receiver, dB.
        text: what was sent.
    """

    sender: str
    begin: float
    end: float
    strength: float
    text: str


class Radio(Sensor):
    """Sends texts to all radios of its channel, and measures the links to them.

    The strength of a signal is ``power`` - 20 log(4 π r f / c) - ``wall_loss`` for each object between (free space,
    Friis 1946). A packet takes its bits divided by ``bit_rate`` and arrives after r / c. It is lost if it is weaker
    than ``sensitivity``, while the receiver sends itself, or if another packet that is not weaker by ``capture``
    overlaps with it.
    """

    _name = "Radio"
    _short_desc = "Packets between robots, with loss, delay and collisions"
    _source = "Friis 1946"
    _builder = BuilderDefaults(frequency=20.0, visual=Visual("cube", (0.02, 0.02, 0.01), (0.1, 0.1, 0.1)))

    add_data("links", [], "list<objects>", "Dictionaries with name, distance (m), rssi (dB), delay (s), connected")
    add_data("received", [], "list<objects>", "Since the last measurement: dictionaries with sender, text, time (s)")
    add_data("lost", 0, "integer", "Packets that were lost here since the last measurement", low=0)
    add_property("channel", 1, "channel", "integer", "Radios of one channel hear each other", low=0, high=10_000)
    add_property("carrier", 2.4e9, "carrier", "float", "Frequency", unit="Hz", low=1e3, high=1e11)
    add_property("power", 20.0, "power", "float", "dBm; of a modem the source level", unit="dB", low=-100.0, high=250.0)
    add_property("sensitivity", -90.0, "sensitivity", "float", "Least strength", unit="dB", low=-200.0, high=200.0)
    add_property("wall_loss", 8.0, "wall_loss", "float", "By an object between", unit="dB", low=0.0, high=200.0)
    add_property("bit_rate", 250e3, "bit_rate", "float", "Bits per second", unit="1/s", low=1.0, high=1e10)
    add_property("capture", 6.0, "capture", "float", "Difference at which the stronger packet survives", unit="dB",
                 low=0.0, high=200.0)  # fmt: skip

    add_state("_sent", list, "Time and text of the newest packets")
    add_state("_before", float, "Time of the last measurement", unit="s")

    channel: int
    carrier: float
    power: float
    sensitivity: float
    wall_loss: float
    bit_rate: float
    capture: float

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self._sent: list[tuple[float, str]] = []
        self._before = self.clock.time

    @service
    def send(self, text: str) -> None:
        """Send a text to all radios of the channel.

        Args:
            text: at most 1,000 bytes in UTF-8.
        """
        size = len(str(text).encode("utf-8", "replace"))
        if size > _LONGEST:
            raise MorseRPCInvokationError(f"{self.name()}: a packet has at most {_LONGEST} bytes, given {size:,}")
        self._sent = [*self._sent, (self.clock.time, str(text))][-_MOST:]

    def speed(self) -> float:
        """Return the speed of the signal, m/s."""
        return 299_792_458.0

    def loss(self, distance: float) -> float:
        """Return the loss by the distance (m), dB."""
        return free_space(distance, self.carrier)

    def duration(self, text: str) -> float:
        """Return the time that a packet takes, s."""
        return 8.0 * (len(text.encode("utf-8", "replace")) + _HEADER) / self.bit_rate

    def measure(self) -> None:
        """Measure the links, and receive."""
        now = self.clock.time
        links: list[dict[str, Any]] = []
        packets: list[_Packet] = []
        for other, source in self._others():
            strength = other.power - other.loss(source.distance) - self.wall_loss * len(walls(self, source.body))
            delay = source.distance / self.speed()
            connected = strength >= self.sensitivity
            links.append(
                {
                    "name": other.name(),
                    "distance": source.distance,
                    "rssi": strength,
                    "delay": delay,
                    "connected": connected,
                }
            )
            for time, text in other._sent:
                begin = time + delay
                packets.append(_Packet(other.name(), begin, begin + other.duration(text), strength, text))
        own = [(time, time + self.duration(text)) for time, text in self._sent]
        received, lost = [], 0
        for packet in sorted(packets, key=lambda one: (one.end, one.sender)):
            if not self._before < packet.end <= now:
                continue
            if packet.strength < self.sensitivity or self._collides(packet, packets, own):
                lost += 1
            else:
                received.append({"sender": packet.sender, "text": packet.text, "time": packet.end})
        self._before = now
        data = self.local_data
        data["links"], data["received"], data["lost"] = links, received, lost

    def _others(self) -> Iterator[tuple[Radio, Source]]:
        """The other radios of the same kind on the channel, with their places."""
        position = self.bge_object.world_pose()[0]
        for other in self.context.components.values():
            if isinstance(other, Radio) and other is not self and type(other) is type(self):
                if other.channel != self.channel:
                    continue
                there = other.bge_object.world_pose()[0]
                away = [b - a for a, b in zip(position, there, strict=True)]
                yield other, Source(other.bge_object, away, sum(part * part for part in away) ** 0.5)

    def _collides(self, packet: _Packet, packets: list[_Packet], own: list[tuple[float, float]]) -> bool:
        if any(begin < packet.end and packet.begin < end for begin, end in own):
            return True
        return any(
            one is not packet
            and one.begin < packet.end
            and packet.begin < one.end
            and one.strength > packet.strength - self.capture
            for one in packets
        )


class AcousticModem(Radio):
    """Sends texts through water: slow, late, and heard far.

    The level of a signal is the source level ``power`` - (20 log r + α r), with the absorption α of Ainslie and McColm
    at ``carrier``; it travels with the speed of sound (Mackenzie), and is lost as a packet of `Radio` is.
    """

    _name = "Acoustic modem"
    _short_desc = "Packets through water, with loss, delay and collisions"
    _source = "Urick, Principles of Underwater Sound; Ainslie and McColm 1998; Mackenzie 1981"
    _builder = BuilderDefaults(
        frequency=10.0,
        visual=Visual("cylinder", (0.03, 0.03, 0.08), (0.1, 0.1, 0.1)),
        properties={"carrier": 25e3, "power": 170.0, "sensitivity": 90.0, "bit_rate": 100.0, "wall_loss": 30.0},
    )

    add_property("temperature", 10.0, "temperature", "float", "Of the water", unit="°C", low=-2.0, high=40.0)
    add_property("salinity", 35.0, "salinity", "float", "Of the water, parts per thousand", low=0.0, high=45.0)

    temperature: float
    salinity: float

    def speed(self) -> float:
        """Return the speed of sound at the depth of the modem below z = 0, m/s."""
        return sound_speed(self.temperature, self.salinity, self._depth())

    def loss(self, distance: float) -> float:
        """Return the loss by spreading and absorption over a distance (m), dB."""
        alpha = absorption(self.carrier, self.temperature, max(self.salinity, 1e-3), self._depth())
        return max(transmission_loss(distance, alpha), 0.0)

    def _depth(self) -> float:
        return max(-float(self.bge_object.world_pose()[0][2]), 0.0)
