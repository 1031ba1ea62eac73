"""What keeps a node from its work: what its callback has raised, or that it does not return."""

from collections.abc import Iterable

from my_robot_basics.exchange import student
from my_robot_basics.feedback.hidden import raised as safely
from my_robot_basics.feedback.hidden import theirs


def what_raised(node_names: Iterable[str]) -> str:
    """A clause on the callback of one of the nodes that has raised, or ''."""
    raised = ((name, student.trouble(name)) for name in sorted(set(node_names)))
    name, said = next((each for each in raised if each[1]), ('', ''))
    if not said:
        return ''
    why = f'its callback raised {safely(said)}'
    if said.endswith('object is not callable'):
        why += ', so give a method by its name, without parentheses'
    field, type_name = student.unpublished_field(name)
    if "'Time' object has no attribute 'sec'" in said:
        why += ', so make a stamp of the time with .to_msg()'
    elif field:
        where, kind = theirs(field), theirs(type_name)
        why += f', so give `{where}` a value of the type `{kind}`'
    elif 'bad argument type for built-in operation' in said:
        why += ', so a field of the message holds a value of another type'
    return why


def what_stopped(node_names: Iterable[str]) -> str:
    """The same; or a clause on the callback of one of them that does not return, or ''."""
    names = sorted(set(node_names))
    if raised := what_raised(names):
        return raised
    said = next(filter(None, map(student.unfinished, names)), '')
    return f'its callback has not returned ({theirs(said)})' if said else ''
