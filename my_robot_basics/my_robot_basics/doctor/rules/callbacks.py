"""Rules about what nodes do: callbacks that do not run, and callbacks that do not return."""

from collections.abc import Iterator

from my_robot_basics.doctor.callback import Callback, Keeps
from my_robot_basics.doctor.evidence import Evidence, Finding, GraphEvidence


def no_clock(evidence: Evidence) -> Iterator[Finding]:
    """A silent publisher uses sim time, but no node publishes /clock.

    Name each publisher's node whose use_sim_time is true, if no node publishes /clock.
    """
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


_WHY: dict[Keeps, str] = {
    'executor': "its executor has one thread, which can't take the response meanwhile",
    'threads': 'all threads of its executor wait like this, so that none can take the response',
    'group': 'the client is in the same callback group, where no other callback can run meanwhile,'
    ' not even the one that takes the response',
}
ASK = 'self.client.call_async(request).add_done_callback(self.receive)'
LATER = 'use call_async, and go on in the function that add_done_callback calls'
_GROUP = 'give the client a group that lets others run (callback_group=ReentrantCallbackGroup())'
_FIX: dict[str, str] = {
    'call': f'{LATER}; or {_GROUP}, and spin the node with a MultiThreadedExecutor',
    'await': f'{_GROUP}; or {LATER}',
    'spin_until_future_complete': f'{LATER}: a callback must not spin its own node',
}


def blocks_itself(evidence: GraphEvidence) -> Iterator[Finding]:
    """A callback waits for a response that can't be taken while the callback waits: a deadlock.

    Name the callback, and how to avoid the deadlock.
    """
    for each in evidence.callbacks:
        ends = [end for end in evidence.all_ends() if end.node_name == each.node_name]
        if not (each.keeps and ends):
            continue
        yield Finding(
            title='a callback waits for its own executor (deadlock)',
            expected=f'the callback {each.name} of {each.node_name} to return, so that the'
            ' response can be taken',
            seen=f'it has waited for at least {int(each.seconds)} s, for the response of'
            f' {each.waits_for}, in {each.line or each.waits_in}; {_WHY[each.keeps]}',
            fix=_FIX[each.waits_in],
            code=ASK,
            broken=tuple(ends[:1]),
        )


def not_returning(evidence: GraphEvidence) -> Iterator[Finding]:
    """A callback does not return, and meanwhile no other callback of its node can run.

    Name the callback, how long it was observed, and the line that it executes.
    """
    for each in evidence.callbacks:
        serves = each.service_name == evidence.name
        ends = [
            end
            for end in evidence.all_ends()
            if end.node_name in each.holds or (serves and end.node_name == each.node_name)
        ]
        if not ends or each.keeps or each.waits_in == 'wait_for_service':
            continue
        job = 'its response is sent' if serves else f'{ends[0].node_name} can go on'
        yield Finding(
            title='a callback has not returned',
            expected=f'the callback {each.name} of {each.node_name} to return, so that {job}',
            seen=_seen(each),
            fix=LATER
            if each.asks
            else 'if it waits for something that does not come, end that; if it only takes long,'
            ' wait, or make the long task an action',
            code=ASK if each.asks else '',
            broken=tuple(ends[:1]),
        )


def _seen(callback: Callback) -> str:
    where = callback.line or 'a line that is not known'
    if callback.asks:
        return (
            f'it has been running for at least {int(callback.seconds)} s, and is in {where}; '
            f"until it returns, the response of {callback.asks} can't be taken"
        )
    return f'it has been running for at least {int(callback.seconds)} s, and is in {where}'


def not_spinning(evidence: Evidence) -> Iterator[Finding]:
    """A node is not spun: its timers do not fire, and its callbacks are not called.

    Name silent publishers, and subscriptions, whose nodes do not answer requests.
    """
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


def silent_publisher(evidence: Evidence) -> Iterator[Finding]:
    """A publisher exists and its node may be spun, but it sends no message.

    Suspect the timer, unless the node is known not to be spun, or waits for /clock.
    """
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
