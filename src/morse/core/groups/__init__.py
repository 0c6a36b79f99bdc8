"""Components that act together."""
