"""Host headers that only look like this machine."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.core.clients.web_access import Access
from tests.kit.effort import examples

_STRANGE = [
    "evil.com@127.0.0.1:8765", "127.0.0.1#.evil", "127.0.0.1?.evil", "127.0.0.1/evil", "127.0.0.1\\.evil",
    "user:secret@localhost", "@localhost", "localhost@", "localhost:99999", "localhost:8765x", "localhost:-1",
    "localhost: 80", " localhost", "localhost ", "localhost\t", "[127.0.0.1]", "[::1", "::1", "[::1]x", "[::1%lo]",
    "localhost,evil.com", "localhost;evil", "localhost..", "", ":8765", "local\u017fhost", "%6cocalhost",
    "127.0.0.1%00.evil", "localhost:80:80", "127.0.0.1:8\u0660",
]  # fmt: skip


def _refusal(host: str) -> str | None:
    return Access("127.0.0.1", None).refusal("/", {"Host": host}, secret=False, cookie="")


@pytest.mark.parametrize("host", _STRANGE)
def test_a_host_that_only_looks_like_this_machine_is_refused(host: str) -> None:
    assert _refusal(host) is not None


@pytest.mark.parametrize(
    "host", ["localhost", "LocalHost:8765", "localhost.:80", "127.0.0.1", "127.0.0.1:8765", "127.1.2.3", "[::1]:8765"]
)
def test_this_machine_is_accepted(host: str) -> None:
    assert _refusal(host) is None


@given(st.text("localhost127.0:@#?/\\[]%;, \t\x00evil", max_size=30))
@settings(max_examples=examples(200))
def test_what_is_accepted_is_a_name_or_an_address_and_a_port(host: str) -> None:
    if _refusal(host) is None:
        name, _, port = host.partition(":")
        assert name in ("localhost", "localhost.") or all(part.isdecimal() for part in name.split("."))
        assert port == "" or port.isdecimal()
