"""What this process changes about rclpy of Jazzy; each module says why."""

from my_robot_basics.live.patches import (
    action_requests,
    action_types,
    child_loggers,
    execute_errors,
    harmless_errors,
    thread_pools,
)


def patch_rclpy() -> None:
    """Change rclpy for all nodes that are created from now on; call this once."""
    harmless_errors.hide()
    thread_pools.let_threads_begin()
    action_types.expect_action_types()
    action_requests.note_requests_first()
    child_loggers.remember_child_loggers()
    execute_errors.print_once()
