"""What the callback of a node has raised."""

from collections.abc import Iterable

from my_robot_basics.exchange import student
from my_robot_basics.feedback.hidden import raised as safely


def what_raised(node_names: Iterable[str]) -> str:
    """A clause on the callback of one of the nodes that has raised, or ''."""
    said = next(filter(None, map(student.trouble, sorted(set(node_names)))), '')
    if not said:
        return ''
    why = f'its callback raised {safely(said)}'
    if said.endswith('object is not callable'):
        why += ', so give a method by its name, without parentheses'
    if "'Time' object has no attribute 'sec'" in said:
        why += ', so make a stamp of the time with .to_msg()'
    if 'bad argument type for built-in operation' in said:
        why += ', so a field of the message holds a value of another type'
    return why
