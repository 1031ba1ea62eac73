"""The lines of Python that fixes show."""

from my_robot_basics.doctor.evidence import Kind

_BEGINNINGS = {
    'publisher': 'self.publisher = self.create_publisher',
    'subscription': 'self.subscription = self.create_subscription',
    'client': 'self.client = self.create_client',
    'server': 'self.service = self.create_service',
}
_ACTIONS = {
    'client': "self.client = ActionClient(self, {}, '{}')",
    'server': "self.server = ActionServer(self, {}, '{}', self.execute)",
}
_REST = {
    'publisher': ', {}',
    'subscription': ', self.receive, {}',
    'client': '',
    'server': ', self.answer',
}
_TYPES = {'publisher': 'JointState', 'subscription': 'JointState'}


def creation_line(kind: Kind, *, type_name: str, name: str, qos_profile: str = '10') -> str:
    """Return the line that creates an endpoint of the topic, service or action `name`.

    `qos_profile` is for topics: a QoSProfile as Python code, or the queue's depth.
    """
    if '/action/' in type_name:
        return _ACTIONS[kind].format(type_name.rpartition('/')[2] or 'MoveArm', name)
    type_ = type_name.rpartition('/')[2] or _TYPES.get(kind, 'SetBool')
    return f"{_BEGINNINGS[kind]}({type_}, '{name}'{_REST[kind].format(qos_profile)})"
