"""All names of `morse.builder`, under the module name that scripts of MORSE 1.0 to 1.4 import them from."""

import morse.builder
from morse.builder import *  # noqa: F403 - the names are those of the list below
from morse.builder.abstractcomponent import timer

__all__ = [*morse.builder.__all__, "timer"]
