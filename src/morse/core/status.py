"""How a service call ended."""

SUCCESS = "SUCCESS"
FAILED = "FAILED"
PREEMPTED = "PREEMPTED"
