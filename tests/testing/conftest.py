import sys
from collections.abc import Callable
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"


@pytest.fixture(autouse=True)
def _own_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ports that no other simulation on this machine is likely to use."""
    monkeypatch.delenv("MORSE_SOCKET_PORT", raising=False)


@pytest.fixture
def fake_morse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Install a ``morse`` whose program is the given Python text."""

    def install(program: str) -> None:
        command = tmp_path / "root" / "bin" / "morse"
        command.parent.mkdir(parents=True)
        command.write_text(f"#!{sys.executable}\nimport os, sys, time, socket\n{program}\n")
        command.chmod(0o755)
        monkeypatch.setenv("MORSE_ROOT", str(tmp_path / "root"))

    return install
