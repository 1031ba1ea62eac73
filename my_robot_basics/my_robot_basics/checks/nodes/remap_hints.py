"""What is wrong with the remap rules and parameters of a command line, judged by their names."""

import re

from my_robot_basics.feedback.errors import shorten
from my_robot_basics.ros2.command_line import OPTIONS_OF_PARAMETERS, CommandLine

_NAMES = '__node', '__name'
_ENDED = (
    'both rules are there, so see whether the node has ended: what it said last is below the cell '
    'with run_commands'
)


def for_a_name(line: CommandLine, node_name: str) -> str:
    """What to try if a node does not have the full name that it should have: one clause."""
    rules = dict(line.rules())
    namespace, _, name = node_name.rpartition('/')
    given = next((rules[left] for left in _NAMES if left in rules), None)
    if '__ns' not in rules:
        return f'a namespace is given by a rule of its own: -r __ns:={namespace}'
    if not rules['__ns'].startswith('/'):
        return f'a namespace begins with /: write -r __ns:={namespace}'
    if rules['__ns'] == f'{namespace}/':
        return f'a namespace has no / at its end: write -r __ns:={namespace}'
    if given is None:
        return f'a name is given by a rule of its own: -r __node:={name}'
    if '/' in given:
        return f'a name has no /, the namespace is in the other rule: write -r __node:={name}'
    if (rules['__ns'], given) != (namespace, name):
        return 'compare both names in the rules of the command line'
    if unfit := line.without_sign(*OPTIONS_OF_PARAMETERS):
        return f'a parameter is written name:=value: {shorten(unfit, 40)!r} is none'
    if prefixed := next(filter(None, map(_without_prefix, _parameters(line))), ''):
        return prefixed
    numbers = [rule for rule in rules.items() if rule[1][:1].isdigit()]
    if numbers:
        left, right = numbers[0]
        return f'-r sets names alone, so give the parameter with -p {left}:={right}'
    return _ENDED


def for_a_parameter(line: CommandLine, name: str, value: object) -> str:
    """What to try if a node's parameter does not have the value that it should: one clause."""
    longer = [each for each in _parameters(line) if re.split('[:/]', each)[-1] == name]
    prefixed = next(filter(None, map(_without_prefix, longer)), '')
    return prefixed or f'give it with -p {name}:={value} after --ros-args, or in a YAML file'


def for_a_topic(line: CommandLine, node_name: str, topic_name: str) -> str:
    """What to try if a node still uses a topic that should be renamed: one clause."""
    namespace = node_name.rpartition('/')[0]
    rules = [(left, right) for left, right in line.rules() if not left.startswith('__')]
    if not rules:
        return (
            f'the name of the topic begins with /, so no namespace moves it: add a rule for it, '
            f'-r {topic_name}:=…'
        )
    if topic_name in (right for _, right in rules):
        return (
            'the name that the topic has in the program is to the left of :=, and the new one to '
            f'its right: -r {topic_name}:=…'
        )
    for left, right in rules:
        if left.strip('/') and not left.startswith('/') and left != topic_name:
            return (
                f'the left side of a rule gets the namespace, too, if it does not begin with /: '
                f'{left} means {namespace}/{left} here, so write {topic_name}:=…'
            )
        if left == topic_name and not right.startswith('/') and '/' in right:
            return (
                f'the right side gets the namespace if it does not begin with /: {right} means '
                f'{namespace}/{right} here'
            )
    return f'compare the rule with the name that the topic has now, {topic_name}'


def _parameters(line: CommandLine) -> list[str]:
    """What is to the left of := in each parameter of the line."""
    return [each.partition(':=')[0] for _, each in line.options(*OPTIONS_OF_PARAMETERS)]


def _without_prefix(left: str) -> str:
    """Advice to leave out the name of a node before a parameter's; '' if there is none."""
    name = re.split('[:/]', left)[-1]
    if name == left:
        return ''
    shown = shorten(left, 40)
    return (
        f'{shown} gives the node no {name}: the command line is of one node, so write '
        f'the name of the parameter alone, -p {name}:=…'
    )
