"""The topic has no publisher."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name the nodes that run."""
    if evidence.publishers:
        return
    running = ', '.join(evidence.nodes)
    types = [end.type_name for end in evidence.subscriptions]
    fix = 'start the node that publishes there, and check that its constructor has this line'
    if not running and not evidence.elsewhere:
        fix = (
            'if it runs already, look into the other ROS domains of this machine, too (--domains,'
            f' or domains=True); else {fix}'
        )
    yield Finding(
        title='no publisher',
        expected=f'a publisher on {evidence.name}',
        seen=f'none; running: {running}' if running else 'none, and no node is running',
        fix=fix,
        code=code.creation_line('publisher', type_name=(types or [''])[0], name=evidence.name),
        missing='publisher',
    )
