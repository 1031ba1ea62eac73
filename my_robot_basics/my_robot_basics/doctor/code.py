"""The lines of Python that the fixes show."""

from my_robot_basics.doctor.evidence import Kind

_BEGINNINGS = {
    'publisher': 'self.publisher = self.create_publisher',
    'subscription': 'self.subscription = self.create_subscription',
}
_CALLBACKS = {'publisher': '', 'subscription': 'self.receive, '}


def create(kind: Kind, *, type_name: str, topic_name: str, qos_profile: str = '10') -> str:
    """The call that makes an endpoint, its QoS profile given as Python or as a queue's depth."""
    type_ = type_name.rpartition('/')[2] or 'JointState'
    return f"{_BEGINNINGS[kind]}({type_}, '{topic_name}', {_CALLBACKS[kind]}{qos_profile})"
