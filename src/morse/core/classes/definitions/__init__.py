"""Classes of components as the text of their files defines them, read without executing the files."""
