"""Runs scenes: loading, ticks, pacing, reset, shutdown."""
