#APPEND
from .@name@ import @classname@
