"""Native code: small C files that are compiled with the package and called without the GIL.

The tests compare every function with a twin in numpy (``tests/kernel/twins``). The first call of `library` loads the
library.
"""

from morse.kernel.loading import library

__all__ = ["library"]
