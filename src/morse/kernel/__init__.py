"""Native code: small C files that are compiled with the package and called without the GIL.

Every function has a twin in numpy, which is the reference; the tests compare both. The library is loaded by the first
call of `library`.
"""

from morse.kernel.loading import library

__all__ = ["library"]
