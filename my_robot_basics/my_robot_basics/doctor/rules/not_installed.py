"""The message type is not installed where the doctor runs, so that no node here can subscribe."""

from collections.abc import Iterator

from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name the type, the nodes that publish it, and the package to install or to source."""
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
