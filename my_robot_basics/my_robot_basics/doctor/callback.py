"""A callback that goes on and on, as the doctor has seen it."""

from dataclasses import dataclass
from typing import Literal

Keeps = Literal['', 'executor', 'threads', 'group']


@dataclass(frozen=True, kw_only=True)
class Callback:
    """A callback of this process that was running, or awaited something, all the time."""

    node_name: str
    """'' where it belongs to no node: what is called when a future is done."""
    name: str
    """Of the function, such as `ask`."""
    line: str
    """Where it is: `line 4: time.sleep(9)`, or '' if that is not known."""
    seconds: float
    """How long it was looked at."""
    service_name: str = ''
    """The service whose request it answers, if it does."""
    waits_in: str = ''
    """`call`, `await`, `spin_until_future_complete` or `wait_for_service`, if it waits in one."""
    waits_for: str = ''
    """The service that it waits for there, where that is known."""
    keeps: Keeps = ''
    """What it keeps from taking the response, if the response can't be taken while it waits: its
    executor's only thread, all threads of its executor, or its callback group."""
    asks: str = ''
    """The service of whose responses one can't be taken before it returns, if there is one."""
    holds: tuple[str, ...] = ()
    """The nodes of which no callback runs while this one does: they share its only thread."""

    def is_sure(self) -> bool:
        """Whether it waits for what can't come by itself: then no longer look is needed."""
        return bool(self.keeps) or self.waits_in == 'wait_for_service'
