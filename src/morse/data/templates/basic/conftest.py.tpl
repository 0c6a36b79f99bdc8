"""Makes the fixture `simulate` known to the tests."""

pytest_plugins = ["morse.testing.fixtures"]
