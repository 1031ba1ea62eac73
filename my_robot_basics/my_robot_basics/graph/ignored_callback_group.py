"""A callback group for entities that an executor should ignore."""

from rclpy.callback_groups import CallbackGroup


class IgnoredCallbackGroup(CallbackGroup):
    """Its entities are never in a wait set, so they neither wake the executor nor run."""

    def can_execute(self, entity: object) -> bool:
        """Return False."""
        return False
