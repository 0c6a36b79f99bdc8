"""``morse check scene.py``: everything in a script that needs a change, at once, and a copy with what can be mended."""

from morse.builder.legacy.check.survey import Finding, Survey, survey

__all__ = ["Finding", "Survey", "survey"]
