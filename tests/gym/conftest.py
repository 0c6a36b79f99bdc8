import sys
from pathlib import Path

# the scenes are a module beside the tests
sys.path.insert(0, str(Path(__file__).parent))
