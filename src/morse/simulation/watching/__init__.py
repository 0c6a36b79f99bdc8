"""Reloads models and components that are edited while a simulation runs."""
