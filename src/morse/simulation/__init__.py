"""Runs scenes: load, tick, pace, reset, shut down."""
