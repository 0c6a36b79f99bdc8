"""Status values of finished service calls."""

SUCCESS = "SUCCESS"
FAILED = "FAILED"
PREEMPTED = "PREEMPTED"
ALL = (SUCCESS, FAILED, PREEMPTED)
