"""Settings of the documentation: ``sphinx-build -W docs docs/_build``."""

import sys
from pathlib import Path

_HERE = Path(__file__).parent
# the documentation describes the sources beside it, whatever is installed
sys.path[:0] = [str(_HERE.parent / "src"), str(_HERE)]

from morse.version import __version__ as release  # noqa: E402, F401

project = "MORSE"
author = "The MORSE developers"
copyright = "2026, The MORSE developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "component_library", "search_words", "tour"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_use_ivar = True  # attributes are documented once
exclude_patterns = ["_build", "_site", "measured"]
templates_path = ["_templates"]
myst_enable_extensions = ["attrs_inline", "deflist", "fieldlist"]
myst_heading_anchors = 3
# links to pages outside of this folder are for readers of the repository, and plain text here
suppress_warnings = ["myst.xref_missing", "ref.python"]

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_js_files = [("runs.js", {"defer": "defer"})]  # modules do not run in pages that are files
html_title = "MORSE"
html_favicon = "../viewer/src/ui/icon.svg"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f7a70", "color-brand-content": "#b4560f"},
    "dark_css_variables": {"color-brand-primary": "#7fd1c4", "color-brand-content": "#f0b673"},
}
_SIDEBAR = ("brand", "search", "versions", "scroll-start", "navigation", "scroll-end")
html_sidebars = {"**": [f"sidebar/{part}.html" for part in _SIDEBAR]}
