"""A build imports parts of the package before the dependencies of the package are installed."""

from pathlib import Path

from tests.kit.programs import python

SOURCES = Path(__file__).resolve().parents[2] / "src"
BUILD = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        base = name.partition(".")[0]
        if base not in sys.stdlib_module_names and base not in ("morse", "msgspec"):
            raise ModuleNotFoundError(f"no {base} in the environment of the build")

sys.meta_path.insert(0, Absent())
from morse.viewer.typescript import typescript
print(typescript())
"""


def test_the_types_of_the_page_are_made_with_the_requirements_of_the_build_alone() -> None:
    done = python("-c", BUILD, folder=SOURCES)
    assert done.returncode == 0, done.stderr
    assert "export " in done.stdout
