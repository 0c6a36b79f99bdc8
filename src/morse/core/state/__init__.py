"""The state of a simulation, which determines its future, as plain data.

Objects with a state have ``get_state()`` and ``set_state(state)``, or their attributes are saved (`writing`,
`reading`). Restoring a state does not execute code from the file, so that files from untrusted sources are safe.
"""

from morse.core.state.reading import Reader
from morse.core.state.values import NoReferences, References, StateError
from morse.core.state.writing import Writer

__all__ = ["NoReferences", "Reader", "References", "StateError", "Writer"]
