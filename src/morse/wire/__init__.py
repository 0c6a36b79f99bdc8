"""What servers of lines of text share: JSON, TCP connections, limits of clients, messages that wait for the tick."""
