"""Messages arrive, but with stamps for which other nodes drop them."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding

MOST_OFF_SEC = 1.0
LONG_SEC = 0.5
"""If all messages over a longer time have one stamp, it is wrong, and they are not one burst."""


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Report stamps of zero, stamps far from the sending time, and stamps that never change."""
    stamped = [each for each in evidence.fresh if hasattr(each.message, 'header')]
    if not stamped:
        return
    stamps = [each.message.header.stamp for each in stamped]
    times = [stamp.sec + stamp.nanosec * 1e-9 for stamp in stamps]
    simulated = any(evidence.state(end.node_name).use_sim_time for end in evidence.publishers)
    off_sec = max(
        (time - each.sent_sec for time, each in zip(times, stamped, strict=True)), key=abs
    )
    if 0.0 in times:
        seen = 'a stamp of 0, as if the message were from 1970'
    elif not simulated and abs(off_sec) > MOST_OFF_SEC:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        seen = f'a stamp {abs(off_sec):.1f} s {side} it'
    elif len(set(times)) == 1 and stamped[-1].sent_sec - stamped[0].sent_sec > LONG_SEC:
        seen = 'the same stamp on every message'
    else:
        return
    yield Finding(
        title='stamps missing or old',
        expected="the time of sending in each message's header.stamp",
        seen=f'{seen}: tf2, RViz2 and message filters drop such messages',
        fix='set the stamp just before each publish',
        code='message.header.stamp = self.get_clock().now().to_msg()',
        broken=evidence.publishers,
    )
