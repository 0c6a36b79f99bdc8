"""``python -m morse`` is the command ``morse``."""

import sys

from morse.cli import main

sys.exit(main())
