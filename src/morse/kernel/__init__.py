"""Native code: small C files that are compiled with the package and called without the GIL.

Every function has a twin in numpy, which is the reference; the tests compare the two. Nothing is loaded
before `library` is called for the first time.
"""

from morse.kernel.loading import library

__all__ = ["library"]
