"""Helper functions for components."""
