"""Recognises programs that mean another server: browsers above all.

Any web page may have the browser of a user connect to any port of the user's machine and send a request of HTTP whose
body the page has written. A server of lines would skip the header as malformed and carry out the body. So the first
line of a connection is looked at before anything of it is used.
"""

from __future__ import annotations

import re

_WHITE = b" \t\r\n\v\f"
#: bytes of the first line that are looked at: its beginning and its end
_HEAD, _TAIL = 256, 64

_METHODS = (
    b"GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI|SEARCH|M-SEARCH|PROPFIND|PROPPATCH|MKCOL|COPY|MOVE|"
    b"LOCK|UNLOCK|REPORT|MERGE|NOTIFY|SUBSCRIBE|UNSUBSCRIBE|DESCRIBE|SETUP|PLAY|REGISTER|INVITE"
)
#: what tells before the line is complete
_HTTP_BEGINS = re.compile(rb"(?:%b)[ \t]+(?:/|\*|[a-z][a-z0-9+.-]*:)" % _METHODS, re.IGNORECASE)
_MAIL_BEGINS = re.compile(
    rb"(?:EHLO|HELO|LHLO)(?:[ \t]|\r?\n)|MAIL FROM:|RCPT TO:|STARTTLS\r?\n|A\d+ (?:CAPABILITY|STARTTLS)", re.IGNORECASE
)
#: a record of the handshake; and the greeting of SSL 2, which offers later versions
_TLS_BEGINS = re.compile(rb"\x16\x03|[\x80-\xff].\x01(?:\x03[\x00-\x04]|\x00\x02)", re.DOTALL)
#: by which browsers look for a way to each other, to any address that a page names; on TCP, a length may stand before
_STUN_BEGINS = re.compile(rb"(?:..)?[\x00-\x3f].{3}\x21\x12\xa4\x42", re.DOTALL)
_SSH_BEGINS = re.compile(rb"SSH-\d")
#: the version at the end of a request, or at the beginning of an answer
_VERSION_ENDS = re.compile(rb"(?:^|[ \t])(?:HTTP/\d|(?:RTSP|SIP|ICAP)/\d\.\d)[\d.]*[ \t\r]*$", re.IGNORECASE)
_ANSWER_BEGINS = re.compile(rb"(?:HTTP|RTSP|SIP|ICAP)/\d", re.IGNORECASE)


class FirstLine:
    """The first line of a connection that is not blank, while it arrives.

    Attributes:
        over: it has arrived as a whole, and is none of a stranger.
    """

    def __init__(self) -> None:
        self.over = False
        self._head = b""
        self._tail = b""

    def stranger(self, data: bytes) -> str | None:
        """The protocol that the other side speaks, or None; call it for all received bytes of the first line."""
        if not self._head:
            data = data.lstrip(_WHITE)
            if not data:
                return None
        line, end, _ = data.partition(b"\n")
        if len(self._head) < _HEAD:
            self._head += line[:_HEAD]
        self._tail = (self._tail + line[-_TAIL:])[-_TAIL:]
        if found := _beginning(self._head + end):
            return found
        if end:
            self.over = True
            return "HTTP" if _VERSION_ENDS.search(self._tail) else None
        return None


def _beginning(head: bytes) -> str | None:
    """What the first bytes of a line tell already."""
    if _TLS_BEGINS.match(head):
        return "TLS"
    if _STUN_BEGINS.match(head):
        return "STUN"
    if _HTTP_BEGINS.match(head) or _ANSWER_BEGINS.match(head):
        return "HTTP"
    if _MAIL_BEGINS.match(head):
        return "mail"
    return "SSH" if _SSH_BEGINS.match(head) else None
