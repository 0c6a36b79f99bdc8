"""The class paths of the text files in scene scripts."""

from morse.middleware.text.datastream import TextDatastreamManager
from morse.middleware.text.streams import CSVPublisher, Publisher

__all__ = ["CSVPublisher", "Publisher", "TextDatastreamManager"]
