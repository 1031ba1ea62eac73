"""What grade cells call: topics, logs, the graph, and the values of a notebook under test.

A check is a ROS node of its own, so the same cell runs in the student's kernel and in the
test kernel of the grader, with the same words. It fails by raising `CheckFailed`; a cell that ends
without an error has passed.

- a value or a function of the answer: `student.value`, `student.call`
- messages of a node: `topic(name).record(...)`, `topic(name).wait_for(...)`
- messages to a node: `topic(name).publish(...)`
- a node that republishes: `relay(source, to=target)`
- a server of the student's: `service(name, type).call(request)`
- an action server of the student's: `action(name, type).send_goal(goal)`
- a client of the student's: `serve(name, type, answer, ...)`, the check's own server
- an action client of the student's: `action_server(name, type, ...)`, the check's own server
- a node's parameters: `node_parameters(node_name)`, `rate_parameter(...)`
- a node that a command line starts: `node_command(name, node_name)`
- a package of the student's, built and run: `package(name)`
- a node's log: `rosout(node_name)`
- a node's name: `expect_node(name)`
- nodes, publishers and subscriptions: `graph()`
- predictions: `Predictions`
- texts of .msg, .srv and .action files: `Definitions`
- anything else: `expect(condition, ...)` and `fail(...)`
- inputs that no student can guess: `inputs(label)`
"""

import importlib

_HOMES = {
    'topic': 'checks.topics',
    'relay': 'checks.relays',
    'service': 'checks.services',
    'action': 'checks.actions',
    'action_server': 'checks.action_servers',
    'serve': 'checks.servers',
    'node_command': 'checks.node_commands',
    'package': 'checks.packages',
    'rosout': 'checks.logs',
    'expect_node': 'checks.node_names',
    'node_parameters': 'checks.parameters',
    'rate_parameter': 'checks.rate_parameters',
    'graph': 'graph.graphs',
    'inputs': 'checks.seeds',
    'expect': 'feedback.errors',
    'fail': 'feedback.errors',
    'Predictions': 'checks.predictions',
    'Definitions': 'checks.definitions',
    'CheckFailed': 'feedback.errors',
    # what these return, or are given
    'Topic': 'checks.topics',
    'Recording': 'checks.recording',
    'Sample': 'checks.recording',
    'Relay': 'checks.relays',
    'Service': 'checks.services',
    'Server': 'checks.servers',
    'Action': 'checks.actions',
    'Outcome': 'checks.actions',
    'ServedAction': 'checks.served_action',
    'Log': 'checks.logs',
    'NodeCommand': 'checks.node_commands',
    'NodeParameters': 'checks.parameters',
    'Package': 'checks.packages',
    'RunningExecutable': 'checks.package_processes',
    'RateParameter': 'checks.rate_parameters',
    'Record': 'checks.node_log',
    'GraphSnapshot': 'graph.snapshot',
    'Stage': 'checks.delivery_experiment',
    'StagePublisher': 'checks.delivery_experiment',
    'StageSubscription': 'checks.delivery_experiment',
}
_MODULES = {
    'ik': 'checks.ik',
    'joints': 'checks.joints',
    'moves': 'checks.moves',
    'player': 'checks.player',
    'replies': 'checks.replies',
    'student': 'exchange.student',
}

__all__ = [*_HOMES, *_MODULES]


def __getattr__(name: str) -> object:
    # on demand: a check that needs no recording loads none
    if name in _MODULES:
        return importlib.import_module(f'my_robot_basics.{_MODULES[name]}')
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(importlib.import_module(f'my_robot_basics.{_HOMES[name]}'), name)
