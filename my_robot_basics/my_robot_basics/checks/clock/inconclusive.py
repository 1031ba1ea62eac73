"""Exceptions that say why a recording on the robot's clock proves nothing."""


class Inconclusive(Exception):
    """The robot's clock proves nothing about this node; the message is a clause that says why."""


class NoMessage(Inconclusive):
    """No message came in the time for which a check waits."""


class TooSlow(Inconclusive):
    """Driving the clock took too long: the node or the machine is too slow."""
