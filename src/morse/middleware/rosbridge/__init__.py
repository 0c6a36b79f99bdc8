"""Topics and services for clients of rosbridge: JSON by WebSocket."""
