"""Services of the simulation itself, as pseudo components that clients call."""
