"""Moving parts of robots."""
