"""Topics and services for Foxglove, over its WebSocket protocol."""
