"""How names are found: of components after variables, of classes after files."""
