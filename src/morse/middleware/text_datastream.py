"""The class paths under which scene scripts know the text files."""

from morse.middleware.text.datastream import TextDatastreamManager
from morse.middleware.text.streams import CSVPublisher, Publisher

__all__ = ["CSVPublisher", "Publisher", "TextDatastreamManager"]
