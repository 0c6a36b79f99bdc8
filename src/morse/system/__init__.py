"""What MORSE takes from the operating system with care: files that may be anything, environment variables."""

from collections.abc import Mapping

OF_MACHINE: Mapping[str, object] = {"of_machine": True}
"""``extra`` of a warning of the log about this computer or installation, which no scene has caused."""
