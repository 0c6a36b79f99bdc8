# What editors and type checkers need to find the classes of this project. Open this folder in your editor.

[tool.pyright]
include = ["."]
extraPaths = ["src"]
reportWildcardImportFromLibrary = false # "from morse.builder import *"

[tool.mypy]
mypy_path = "src"
explicit_package_bases = true

[tool.pytest.ini_options]
pythonpath = ["src"]
