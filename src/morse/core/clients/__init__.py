"""Clients of all servers: how they connect, and their shares of time, memory and descriptors."""
