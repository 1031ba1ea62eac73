"""What grade cells call: topics, logs, the graph, and the values of a notebook under test.

A check is a ROS node of its own, so the same cell runs in the student's kernel and in the
test kernel of the grader, with the same words. It fails by raising `CheckFailed`; a cell that ends
without an error has passed.

- a value or a function of the answer: `student.value`, `student.call`
- messages of a node: `topic(name).record(...)`, `topic(name).wait_for(...)`
- messages to a node: `topic(name).publish(...)`
- a node that republishes: `relay(source, to=target)`
- a node's log: `rosout(node_name)`
- nodes, publishers and subscriptions: `graph()`
- predictions: `Predictions`
- anything else: `expect(condition, ...)` and `fail(...)`
- inputs that no student can guess: `inputs(label)`
"""

import importlib

_HOMES = {
    'topic': 'topics',
    'relay': 'relays',
    'rosout': 'logs',
    'graph': 'graphs',
    'inputs': 'seeds',
    'expect': 'errors',
    'fail': 'errors',
    'Predictions': 'predictions',
    'CheckFailed': 'errors',
    # what these return, or are given
    'Topic': 'topics',
    'Recording': 'recording',
    'Sample': 'recording',
    'Relay': 'relays',
    'Log': 'logs',
    'Record': 'logs',
    'Graph': 'graphs',
    'Stage': 'stage',
    'StagePublisher': 'stage',
    'StageSubscription': 'stage',
}
_MODULES = ('joints', 'student')

__all__ = [*_HOMES, *_MODULES]


def __getattr__(name: str) -> object:
    # On demand: a student's kernel that only answers questions (responder.py) loads no check.
    if name in _MODULES:
        return importlib.import_module(f'my_robot_basics.checks.{name}')
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(importlib.import_module(f'my_robot_basics.checks.{_HOMES[name]}'), name)


importlib.import_module('my_robot_basics.checks.tick').watch()
