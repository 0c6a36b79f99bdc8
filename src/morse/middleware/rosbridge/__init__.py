"""Topics and services for clients of rosbridge: JSON over WebSocket."""
