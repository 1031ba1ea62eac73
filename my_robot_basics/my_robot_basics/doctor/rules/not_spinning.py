"""Nobody spins a node: its timers do not fire, and its callbacks are not called."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name silent publishers, and subscriptions, whose nodes answer no question."""
    ends = (() if evidence.heard else evidence.publishers) + evidence.subscriptions
    for end in ends:
        if evidence.state(end.node_name).answers is not False:
            continue
        job = 'its timers fire' if end.kind == 'publisher' else 'the callback is called'
        yield Finding(
            title='nobody spins the node',
            expected=f'{end.node_name} to be spun, so that {job}',
            seen='it is on the graph and answers no question',
            mend='spin it; in a notebook, start it with live.run(…). If it was spun, an exception'
            ' in a callback has ended that, or a callback does not return: read its output',
            code='rclpy.spin(node)',
            broken=(end,),
        )
