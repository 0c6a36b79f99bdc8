"""The data of a component on their way to streams, and commands on their way to the component."""
