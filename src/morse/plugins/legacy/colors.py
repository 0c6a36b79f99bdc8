"""The colours of terminals that scripts of MORSE 1.0 print: empty, because MORSE colours its log itself."""

__all__ = ["bcolors", "fail", "header", "okblue", "okgreen", "warning"]


class bcolors:  # noqa: N801 (the name of MORSE 1.0)
    """Sequences of a terminal."""

    HEADER = OKBLUE = OKGREEN = WARNING = FAIL = ENDC = ""

    def disable(self) -> None:
        """Accepted: they are empty already."""


def _plain(text: object) -> str:
    return str(text)


header = okblue = okgreen = warning = fail = _plain
