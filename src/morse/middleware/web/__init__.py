"""What the middlewares have in common that are reached by WebSocket."""
