"""A callback group for what nobody waits for."""

from rclpy.callback_groups import CallbackGroup


class Unheeded(CallbackGroup):
    """What comes for its entities is left where it is: nobody is woken up for it."""

    def can_execute(self, entity: object) -> bool:
        """Never."""
        return False
