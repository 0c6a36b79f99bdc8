"""The benchmarks and their targets.

Each is a function from a `Plan` to rows of the table.
"""
