"""From a scene script to a running simulation, with a live view if asked for."""
