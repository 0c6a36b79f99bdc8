"""Services that list the streams; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import short
from morse.core.services import service

if TYPE_CHECKING:
    from collections.abc import Mapping


class StreamDirectory(AbstractObject):
    """Names and ports of the streams.

    Args:
        ports: by name of the component.
        binary_port: port of the binary streams.
    """

    def __init__(self, ports: Mapping[str, int], binary_port: int) -> None:
        super().__init__()
        self._ports = ports
        self._binary_port = binary_port

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def list_streams(self) -> list[str]:
        """The names of the components that have a stream."""
        return list(self._ports)

    @service(changes=False)
    def get_stream_port(self, name: str) -> int:
        """The TCP port of the stream of a component."""
        if not isinstance(name, str) or name not in self._ports:
            hint = nearest(str(name), list(self._ports))
            raise MorseRPCInvokationError(f"Stream unavailable for component {short(name)}{hint}")
        return self._ports[name]

    @service(changes=False)
    def get_all_stream_ports(self) -> dict[str, int]:
        """The TCP ports of all streams, by the name of the component."""
        return dict(self._ports)

    @service(changes=False)
    def get_binary_port(self) -> int:
        """The TCP port of the binary streams of all sensors."""
        return self._binary_port
