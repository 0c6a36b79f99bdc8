"""Clients reach the simulation by TCP: services as lines of text, data streams as lines of JSON."""
