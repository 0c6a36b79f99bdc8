import importlib.util
import sys
from pathlib import Path

# the scenes are a module beside the tests
sys.path.insert(0, str(Path(__file__).parent))

# an extra: without it there is nothing to test
collect_ignore = [] if importlib.util.find_spec("gymnasium") else ["test_gym.py"]
