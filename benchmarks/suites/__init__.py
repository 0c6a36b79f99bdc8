"""The benchmarks: what is run, what is wanted of it.

Each is a function from a `Plan` to lines of the table.
"""
