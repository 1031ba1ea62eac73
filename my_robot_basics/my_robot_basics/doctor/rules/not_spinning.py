"""A node is not spun: its timers do not fire, and its callbacks are not called."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name silent publishers, and subscriptions, whose nodes do not answer requests."""
    ends = (() if evidence.received else evidence.publishers) + evidence.subscriptions
    for end in ends:
        if evidence.busy(end.node_name) or evidence.state(end.node_name).answers is not False:
            continue
        job = 'its timers fire' if end.kind == 'publisher' else 'the callback is called'
        yield Finding(
            title='the node is not spinning',
            expected=f'{end.node_name} to be spun, so that {job}',
            seen='it is on the graph and does not answer requests',
            fix='spin it; in a notebook, start it with live.run(…). If it was spinning, an'
            ' exception in a callback has ended that, or a callback does not return: read its log',
            code='rclpy.spin(node)',
            broken=(end,),
        )
