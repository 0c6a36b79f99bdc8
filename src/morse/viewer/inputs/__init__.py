"""What the driving page asks for."""
