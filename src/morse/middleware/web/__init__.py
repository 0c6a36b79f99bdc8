"""Common parts of the WebSocket middlewares."""
