"""Where clients come in: every server of a simulation accepts its connections through an `Acceptor`."""

from morse.core.clients.acceptors.acceptor import Acceptor, Acceptors, ClientConnection, acceptors_of
from morse.core.clients.acceptors.descriptors import DESCRIPTORS, Descriptors

__all__ = ["DESCRIPTORS", "Acceptor", "Acceptors", "ClientConnection", "Descriptors", "acceptors_of"]
