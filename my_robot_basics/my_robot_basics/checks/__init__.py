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

The code is in packages; each imports only from those before it in LAYERS:

- `values`: What an answer returns or logs: angles, positions, definitions, predictions.
- `clock`: The robot's clock, which a check drives, and what a node's answers prove about it.
- `recordings`: When a topic's messages came and what they were: rates, stamps, positions.
- `topics`: A topic: its endpoints, recordings on either clock, messages to it, a node's count.
- `relays`: A node that republishes: which message comes out for which, and what it leaves out.
- `services`: Services: the check's client of the student's server, and its server for a client.
- `nodes`: A node's name, log and parameters, and a node that a command line starts.
- `actions`: Actions: the check's client of the student's server, and its server for a client.
- `arm`: What the server and the client of `/move_arm` have to do.
- `packages`: A package of the student's, built and run, and what `arm_player` has to do.
"""

import importlib

LAYERS = (
    'values',
    'clock',
    'recordings',
    'topics',
    'relays',
    'services',
    'nodes',
    'actions',
    'arm',
    'packages',
)
"""The packages, lowest layer first."""
_HOMES = {
    'topic': 'checks.topics.topics',
    'relay': 'checks.relays.relays',
    'service': 'checks.services.services',
    'action': 'checks.actions.actions',
    'action_server': 'checks.actions.action_servers',
    'serve': 'checks.services.servers',
    'node_command': 'checks.nodes.node_commands',
    'package': 'checks.packages.packages',
    'rosout': 'checks.nodes.logs',
    'expect_node': 'checks.nodes.node_names',
    'node_parameters': 'checks.nodes.parameters',
    'rate_parameter': 'checks.nodes.rate_parameters',
    'graph': 'graph.graphs',
    'inputs': 'checks.values.seeds',
    'expect': 'feedback.errors',
    'fail': 'feedback.errors',
    'Predictions': 'checks.values.predictions',
    'Definitions': 'checks.values.definitions',
    'CheckFailed': 'feedback.errors',
    # what these return, or are given
    'Topic': 'checks.topics.topics',
    'Recording': 'checks.recordings.recording',
    'RecordedMessages': 'checks.recordings.recorded_messages',
    'Sample': 'checks.recordings.recorded_messages',
    'Relay': 'checks.relays.relays',
    'Service': 'checks.services.services',
    'Server': 'checks.services.servers',
    'Action': 'checks.actions.actions',
    'Outcome': 'checks.actions.actions',
    'ServedAction': 'checks.actions.served_action',
    'Log': 'checks.nodes.logs',
    'NodeCommand': 'checks.nodes.node_commands',
    'NodeParameters': 'checks.nodes.parameters',
    'Package': 'checks.packages.packages',
    'RunningExecutable': 'checks.packages.package_processes',
    'RateParameter': 'checks.nodes.rate_parameters',
    'Record': 'checks.nodes.node_log',
    'GraphSnapshot': 'graph.snapshot',
    'Stage': 'checks.values.delivery_experiment',
    'StagePublisher': 'checks.values.delivery_experiment',
    'StageSubscription': 'checks.values.delivery_experiment',
}
_MODULES = {
    'ik': 'checks.services.ik',
    'joints': 'checks.values.joints',
    'moves': 'checks.arm.moves',
    'player': 'checks.packages.player',
    'replies': 'checks.arm.replies',
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
