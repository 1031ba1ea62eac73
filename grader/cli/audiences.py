"""Who can send to a student's ROS nodes, and receive from them, by way of running the course."""

from collections.abc import Iterator, Sequence

from grader.kernels.isolation import Protection

NEEDED = ('user and mount', 'network namespace', 'PID namespace')
"""Parts of the names of those protections that a room on a hub needs."""
WAYS = (
    ('./course lab, a machine of your own', 'what runs on that machine'),
    (
        './course lab on a shared machine, a plain JupyterHub',
        'any user of the machine who sets the same ROS domain: nothing prevents that',
    ),
    (
        'a JupyterHub of deploy/jupyterhub/',
        'what the student has started: each server has a network of its own',
    ),
    ('./course grade, ./course serve', "the submission and its test: nobody else's"),
)


def describe_audiences(protections: Sequence[Protection]) -> Iterator[str]:
    """Yield lines about each way of running, and whether this machine could be such a hub."""
    yield "Who can send to a student's ROS nodes, and receive from them:"
    for way, who in WAYS:
        yield f'  {way}:\n      {who}'
    lacking = [p.name for p in protections if p.problem and any(n in p.name for n in NEEDED)]
    if lacking:
        yield f'This machine cannot be such a hub, without {" and ".join(lacking)}.'
