"""Requests of the driving page."""
