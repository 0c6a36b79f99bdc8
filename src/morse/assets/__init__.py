"""Model files of robots, objects and environments: search, readers and collision shapes."""

from morse.assets.formats import SUFFIXES, UnsupportedFormatError
from morse.assets.loader import instantiate, load
from morse.assets.search import AssetNotFoundError, find

__all__ = ["SUFFIXES", "AssetNotFoundError", "UnsupportedFormatError", "find", "instantiate", "load"]
