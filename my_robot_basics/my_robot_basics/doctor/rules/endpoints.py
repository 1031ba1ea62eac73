"""Rules about endpoints: which are missing, where they are, and whether they fit each other."""

from collections.abc import Iterator

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import VERBS, Evidence, Finding, GraphEvidence
from my_robot_basics.graph.qos_compatibility import incompatible_policies


def discovery_range(evidence: GraphEvidence) -> Iterator[Finding]:
    """A process of this domain runs on this machine, but is not on the graph.

    Suspect the discovery range if an end is missing and a process is not discovered.
    """
    missing = next((k for k in evidence.NEEDED if not evidence.ends(k)), None)
    if missing is None or evidence.missing_participants <= 0:
        return
    number = evidence.missing_participants
    yield Finding(
        title='a process that cannot be discovered',
        expected=f'every process of ROS domain {evidence.domain_id} on this machine to be found',
        seen=(
            f'{number} are running in it and not on the graph: their discovery range may be OFF'
            if number > 1
            else '1 is running in it and not on the graph: its discovery range may be OFF'
        ),
        fix='restart that node in a terminal in which this line was run',
        code='$ export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST',
        missing=missing,
    )


def other_domain(evidence: GraphEvidence) -> Iterator[Finding]:
    """The other end is on this machine, in another ROS domain.

    Name the domain, if other domains were searched.
    """
    for kind in evidence.NEEDED:
        if evidence.ends(kind):
            continue
        for domain_id, ends in evidence.elsewhere.items():
            found = [end for end in ends if end.kind == kind]
            if not found:
                continue
            who, where = found[0].node_name, f'ROS domain {evidence.domain_id}'
            yield Finding(
                title='another domain ID',
                expected=f'a {kind} on {evidence.name} in {where}'
                if evidence.OF == 'on'
                else f'a {kind} of {evidence.name} in {where}',
                seen=f'{who} {VERBS[kind]} there in domain {domain_id}: different domains'
                ' never meet',
                fix=f'start {who} again in a terminal in which this line was run',
                code=f'$ export ROS_DOMAIN_ID={evidence.domain_id}',
                broken=(found[0],),
                missing=kind,
            )


def no_publisher(evidence: Evidence) -> Iterator[Finding]:
    """The topic has no publisher.

    Name the nodes that run.
    """
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


def no_subscription(evidence: Evidence) -> Iterator[Finding]:
    """The topic has no subscription.

    Name the nodes that publish on it.
    """
    if evidence.subscriptions:
        return
    senders = ' and '.join(end.node_name for end in evidence.publishers)
    types = [end.type_name for end in evidence.publishers]
    yield Finding(
        title='no subscription',
        expected=f'a subscription on {evidence.name}',
        seen=f'none; the publisher belongs to {senders}' if senders else 'none',
        fix='start the node that subscribes, and check that its constructor has this line',
        code=code.creation_line('subscription', type_name=(types or [''])[0], name=evidence.name),
        missing='subscription',
    )


def different_types(evidence: Evidence) -> Iterator[Finding]:
    """The two ends were created with different message types.

    Name both types; the publisher's type is taken as the right one.
    """
    types = {publisher.type_name: publisher.node_name for publisher in evidence.publishers}
    for subscription in evidence.subscriptions:
        if not types or subscription.type_name in types:
            continue
        type_name, sender = next(iter(types.items()))
        yield Finding(
            title='types differ',
            expected='one message type at both ends',
            seen=f'{sender} publishes {type_name}, {subscription.node_name} expects'
            f' {subscription.type_name}: no message arrives',
            fix=f'use the same type in {subscription.node_name}'
            f' (from {type_name.replace("/", ".").rpartition(".")[0]})',
            code=code.creation_line('subscription', type_name=type_name, name=evidence.name),
            broken=(subscription,),
        )


def not_installed(evidence: Evidence) -> Iterator[Finding]:
    """The message type is not installed where the doctor runs, so that no node here can subscribe.

    Name the type, the nodes that publish it, and the package to install or to source.
    """
    for type_name in evidence.unknown_types:
        ends = tuple(end for end in evidence.publishers if end.type_name == type_name)
        senders = ' and '.join(sorted({end.node_name for end in ends}))
        package = type_name.partition('/')[0]
        yield Finding(
            title='message type not installed here',
            expected=f'{type_name}, which {senders} publishes, to be installed here',
            seen='this environment does not have the type: its nodes cannot subscribe, and the'
            ' doctor cannot see whether messages arrive at nodes of another environment',
            fix=f'install the package {package} here, or source the workspace in which it was'
            ' built, and start again from there',
            code='$ source install/setup.bash',
            broken=ends,
        )


def qos(evidence: Evidence) -> Iterator[Finding]:
    """A subscription requests a stronger QoS policy than a publisher offers.

    Name each pair of ends that does not match, the policies, and the subscription's fix.
    """
    for subscription in evidence.subscriptions:
        for publisher in evidence.publishers:
            if publisher.type_name != subscription.type_name:
                continue
            offered, asked = publisher.qos_profile, subscription.qos_profile
            gaps = incompatible_policies(offered, asked)
            if not gaps:
                continue
            names = ' and '.join(gaps)
            yield Finding(
                title=f'QoS incompatible: {names}',
                expected=f'{publisher.node_name} to offer what {subscription.node_name} requests',
                seen='; '.join(
                    f'{policy}: {publisher.node_name} offers {has}, {subscription.node_name}'
                    f' requests {wants}'
                    for policy, (has, wants) in gaps.items()
                ),
                fix=f'request no more than is offered, in {subscription.node_name}',
                code=code.creation_line(
                    'subscription',
                    type_name=subscription.type_name,
                    name=evidence.name,
                    qos_profile=_compatible_profile(offered, asked),
                ),
                broken=(subscription,),
            )


def _compatible_profile(offered: QoSProfile, asked: QoSProfile) -> str:
    """Return a compatible QoSProfile as Python code, as close to the requested one as possible."""
    gaps = incompatible_policies(offered, asked)
    reliable = asked.reliability == ReliabilityPolicy.RELIABLE and 'RELIABILITY' not in gaps
    parts = ['depth=10', f'reliability=ReliabilityPolicy.{_RELIABILITY[reliable]}']
    if asked.durability == DurabilityPolicy.TRANSIENT_LOCAL and 'DURABILITY' not in gaps:
        parts.append('durability=DurabilityPolicy.TRANSIENT_LOCAL')
    # policies that are left out have defaults that any offer satisfies
    return f'QoSProfile({", ".join(parts)})'


_RELIABILITY = {True: 'RELIABLE', False: 'BEST_EFFORT'}
