import sys

import pytest
from doc_pages import DOCS


@pytest.fixture(scope="module")
def library():
    """The extension that generates the component library."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        import component_library

        yield component_library
    for name in [name for name in sys.modules if name.partition(".")[0] == "component_library"]:
        del sys.modules[name]
