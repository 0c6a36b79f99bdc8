"""The state of a whole simulation: collected, saved, restored."""
