"""Camera images rendered from triangles."""
