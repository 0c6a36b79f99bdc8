"""The data of components as variables of a MOOS database."""
