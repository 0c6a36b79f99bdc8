"""Plug-ins: parts that no simulation needs, on the interface that extensions of users have.

Each folder is a package of its own, which an entry point of ``pyproject.toml`` names. Nothing outside of this room
imports it or knows its names, and a plug-in imports only the public modules that ``docs/architecture.md`` lists.
"""
