"""The doctor's evidence on a callback that does not return."""

from dataclasses import dataclass
from typing import Literal

Keeps = Literal['', 'executor', 'threads', 'group']


@dataclass(frozen=True, kw_only=True)
class Callback:
    """A callback of this process that was running or awaiting something during the whole look."""

    node_name: str
    """Its node's full name; '' if it has no node, as a done callback of a future."""
    name: str
    """The name of the function, such as `ask`."""
    line: str
    """The line that it executes: `line 4: time.sleep(9)`, or '' if unknown."""
    seconds: float
    """How long it was observed."""
    service_name: str = ''
    """The service whose request it handles, or ''."""
    waits_in: str = ''
    """`call`, `await`, `spin_until_future_complete` or `wait_for_service`, if it waits in one."""
    waits_for: str = ''
    """The service that it waits for there, or '' if unknown."""
    keeps: Keeps = ''
    """What it blocks, if this keeps the response that it waits for from being taken: its
    executor's only thread, all threads of its executor, or its callback group."""
    asks: str = ''
    """A service with a pending response that can't be taken before the callback returns, or ''."""
    holds: tuple[str, ...] = ()
    """The nodes whose other callbacks can't run meanwhile: they share its thread or its group."""

    def is_sure(self) -> bool:
        """Whether it waits for something that can't come by itself, which needs no longer look."""
        return bool(self.keeps) or self.waits_in == 'wait_for_service'
