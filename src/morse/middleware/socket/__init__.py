"""TCP clients: services as lines of text, data streams as lines of JSON."""
