"""All that determines the future of a simulation, as plain data.

Holders of state have ``get_state()`` and ``set_state(state)``, or are saved by their attributes (`writing`, `reading`).
Nothing here executes what a file says: a file of a state that comes from elsewhere may be refused, but does no harm.
"""

from morse.core.state.errors import StateError
from morse.core.state.reading import Reader
from morse.core.state.references import References
from morse.core.state.writing import Writer

__all__ = ["Reader", "References", "StateError", "Writer"]
