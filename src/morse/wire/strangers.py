"""Detects clients with another protocol, above all browsers.

Any web page can make the browser of a user connect to any port of the user's machine and send an HTTP request whose
body the page has written. A line-based server would skip the header as malformed and execute the body. Therefore the
first line of a connection is inspected before any of it is processed.
"""

from __future__ import annotations

import re

_WHITE = b" \t\r\n\v\f"
#: number of inspected bytes of the first line: its beginning and its end
_HEAD, _TAIL = 256, 64

_METHODS = (
    b"GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI|SEARCH|M-SEARCH|PROPFIND|PROPPATCH|MKCOL|COPY|MOVE|"
    b"LOCK|UNLOCK|REPORT|MERGE|NOTIFY|SUBSCRIBE|UNSUBSCRIBE|DESCRIBE|SETUP|PLAY|REGISTER|INVITE"
)
#: patterns that identify a protocol before the line is complete
_HTTP_BEGINS = re.compile(rb"(?:%b)[ \t]+(?:/|\*|[a-z][a-z0-9+.-]*:)" % _METHODS, re.IGNORECASE)
_MAIL_BEGINS = re.compile(
    rb"(?:EHLO|HELO|LHLO)(?:[ \t]|\r?\n)|MAIL FROM:|RCPT TO:|STARTTLS\r?\n|A\d+ (?:CAPABILITY|STARTTLS)", re.IGNORECASE
)
#: a TLS handshake record; and the SSL 2 hello, which offers later versions
_TLS_BEGINS = re.compile(rb"\x16\x03|[\x80-\xff].\x01(?:\x03[\x00-\x04]|\x00\x02)", re.DOTALL)
#: STUN, which browsers send to any address that a page names; on TCP, a length may precede it
_STUN_BEGINS = re.compile(rb"(?:..)?[\x00-\x3f].{3}\x21\x12\xa4\x42", re.DOTALL)
_SSH_BEGINS = re.compile(rb"SSH-\d")
#: the HTTP version at the end of a request, or at the beginning of a response
_VERSION_ENDS = re.compile(rb"(?:^|[ \t])(?:HTTP/\d|(?:RTSP|SIP|ICAP)/\d\.\d)[\d.]*[ \t\r]*$", re.IGNORECASE)
_ANSWER_BEGINS = re.compile(rb"(?:HTTP|RTSP|SIP|ICAP)/\d", re.IGNORECASE)


class FirstLine:
    """Inspects the first line of a connection that is not blank.

    Attributes:
        over: the line is complete and of no other protocol.
    """

    def __init__(self) -> None:
        self.over = False
        self._head = b""
        self._tail = b""

    def stranger(self, data: bytes) -> str | None:
        """The protocol of the client, or None; called for all received bytes of the first line."""
        if not self._head:
            data = data.lstrip(_WHITE)
            if not data:
                return None
        line, end, _ = data.partition(b"\n")
        if len(self._head) < _HEAD:
            self._head += line[:_HEAD]
        self._tail = (self._tail + line[-_TAIL:])[-_TAIL:]
        if stranger_line := _beginning(self._head + end):
            return stranger_line
        if end:
            self.over = True
            return "HTTP" if _VERSION_ENDS.search(self._tail) else None
        return None


def _beginning(head: bytes) -> str | None:
    """The protocol as far as the first bytes of a line determine it."""
    if _TLS_BEGINS.match(head):
        return "TLS"
    if _STUN_BEGINS.match(head):
        return "STUN"
    if _HTTP_BEGINS.match(head) or _ANSWER_BEGINS.match(head):
        return "HTTP"
    if _MAIL_BEGINS.match(head):
        return "mail"
    return "SSH" if _SSH_BEGINS.match(head) else None
