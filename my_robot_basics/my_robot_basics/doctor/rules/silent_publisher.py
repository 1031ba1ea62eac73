"""A publisher exists and its node may be spun, but it sends no message."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Suspect the timer, unless the node is known not to be spun, or waits for /clock."""
    if evidence.received or not evidence.listened_sec:
        return
    for publisher in evidence.publishers:
        state = evidence.state(publisher.node_name)
        if state.answers is False or (state.use_sim_time and not evidence.has_clock):
            continue
        alive = 'is spun, and' if state.answers else 'is on the graph, and'
        yield Finding(
            title='the timer never fires',
            expected=f'messages of {publisher.node_name} on {evidence.name}',
            seen=f'it {alive} sent none in {evidence.listened_sec:.1f} s',
            fix='check that the constructor creates a timer, that its period is in seconds and'
            ' that the callback calls publish',
            code='self.timer = self.create_timer(0.2, self.publish)',
            broken=(publisher,),
        )
