"""Model files of robots, objects and environments: search, readers and collision shapes."""

from morse.assets.formats import UnsupportedFormatError, suffixes
from morse.assets.loader import instantiate, load
from morse.assets.search import AssetNotFoundError, find

__all__ = ["AssetNotFoundError", "UnsupportedFormatError", "find", "instantiate", "load", "suffixes"]
