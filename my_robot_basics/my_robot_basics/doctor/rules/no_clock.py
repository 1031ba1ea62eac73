"""A silent publisher uses sim time, but no node publishes /clock."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name each publisher's node whose use_sim_time is true, if no node publishes /clock."""
    if evidence.received or evidence.has_clock:
        return
    for publisher in evidence.publishers:
        if evidence.state(publisher.node_name).use_sim_time:
            yield Finding(
                title='use_sim_time without a /clock',
                expected=f'a /clock, which {publisher.node_name} needs (use_sim_time is true)',
                seen='no node publishes /clock: its time stays at 0, and no timer fires',
                fix='start the simulator, or let the node use the wall clock',
                code=f'$ ros2 param set {publisher.node_name} use_sim_time false',
                broken=(publisher,),
            )
