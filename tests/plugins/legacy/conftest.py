from script_fixtures import _fresh_builder, load  # noqa: F401 (fixtures)
