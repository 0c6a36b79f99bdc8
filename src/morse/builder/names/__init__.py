"""Names of components from variables, and names of classes from files."""
