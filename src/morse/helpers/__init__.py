"""Small tools for writing components."""
