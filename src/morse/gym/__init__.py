"""Tasks of reinforcement learning for Gymnasium and PettingZoo; with the extra ``gym``."""

try:
    import gymnasium as _gymnasium  # noqa: F401
except ImportError:
    from morse.system.extras import install as _install

    raise ImportError(f"morse.gym needs Gymnasium: {_install('gym')}") from None

from morse.gym.env import TaskEnv
from morse.gym.registration import register, register_all
from morse.gym.task import Command, Read, Task, Touch
from morse.gym.vector import TaskVectorEnv, vector

__all__ = [
    "Command",
    "Read",
    "Task",
    "TaskEnv",
    "TaskVectorEnv",
    "Touch",
    "baselines",
    "parallel",
    "register",
    "vector",
]


def __getattr__(name: str) -> object:
    if name == "parallel":  # it needs PettingZoo
        from morse.gym.agents import parallel

        return parallel
    if name == "baselines":  # it needs Stable-Baselines3
        from morse.gym.stable_baselines import baselines

        return baselines
    raise AttributeError(f"module 'morse.gym' has no attribute '{name}'")


register_all()
