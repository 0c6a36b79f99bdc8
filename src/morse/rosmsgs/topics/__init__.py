"""The topics of all components, on a backend that transports or stores their messages."""
