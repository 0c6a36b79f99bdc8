"""Streams over the socket that are more than the data of a component as JSON."""
