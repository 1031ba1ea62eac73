"""Why a look on the robot's clock proves nothing."""


class Inconclusive(Exception):
    """The simulated look proves nothing; the message is a clause that says why."""


class NoMessage(Inconclusive):
    """No message came for as long as one is waited for."""


class TooSlow(Inconclusive):
    """There was no time for it: the node is slow, or the machine."""
