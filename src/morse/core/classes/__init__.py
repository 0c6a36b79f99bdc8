"""Classes of components: where they are declared, found, and imported from."""
