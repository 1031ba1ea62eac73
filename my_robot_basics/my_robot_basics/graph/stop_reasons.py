"""What stopped a node: an exception of a callback or thread, or a callback that never returns."""

import re
from collections.abc import Iterable

from my_robot_basics.exchange import node_troubles, wire
from my_robot_basics.feedback.hidden import student_exception, student_text
from my_robot_basics.feedback.python_errors import hint_for_exception, with_hint

_GETS_TOO_LITTLE = re.compile(r'\(\) missing \d+ required positional arguments?: ([^(]*)$')
"""What Python says if a function needs more than rclpy gives it: no line of the student's calls
it, so no line is named behind it."""
_OF_AN_ATTRIBUTE = 'AttributeError', 'TypeError'
"""What rclpy raises if an attribute of its own holds something else."""
_NO_STAMP = re.compile(r"'(?:Time|function|method)' object has no attribute 'sec'")
"""What Python says of a stamp that is a Time, or a to_msg without its parentheses."""


def what_raised(node_names: Iterable[str]) -> str:
    """A clause about the exception of a callback of one of the nodes, or ''."""
    raised = ((name, node_troubles.last_raised(name)) for name in sorted(set(node_names)))
    name, said = next((each for each in raised if each[1]), ('', ''))
    if not said:
        return ''
    why = f'its callback raised {student_exception(said)}'
    if said.startswith(_OF_AN_ATTRIBUTE) and (mine := what_is_overwritten(name)):
        return f'{why}, because {mine}'
    if said.endswith('object is not callable') and not hint_for_exception(said):
        why += ', so give a method by its name, without parentheses'
    if found := _GETS_TOO_LITTLE.search(said):
        return why + _why_too_little(student_text(found[1]))
    field, type_name = node_troubles.unpublished_field(name)
    if _NO_STAMP.search(said):
        why += ', so make a stamp of the time with .to_msg()'
        return why
    if field:
        where, kind = student_text(field), student_text(type_name)
        why += f', so give `{where}` a value of the type `{kind}`'
    elif type_name:
        why += f', so what you give it has to be made with `{student_text(type_name)}`'
    elif 'bad argument type for built-in operation' in said:
        why += ', so a field of the message holds a value of another type'
    return with_hint(why)


def what_stopped(node_names: Iterable[str]) -> str:
    """The same, else a clause about an unfinished callback or a thread that raised, or ''."""
    names = sorted(set(node_names))
    if raised := what_raised(names):
        return raised
    why = what_has_not_returned(names) or what_ended_a_thread()
    return why or next(filter(None, map(what_is_overwritten, names)), '')


def what_has_not_returned(node_names: Iterable[str]) -> str:
    """A clause about an unfinished callback of one of the nodes, or ''."""
    lines = map(node_troubles.blocking_line, sorted(set(node_names)))
    said = next(filter(None, lines), '')
    return f'its callback has not returned ({student_text(said)})' if said else ''


def what_is_overwritten(node_name: str) -> str:
    """A clause about one of Node's own attributes that the node has overwritten, or ''."""
    attribute = node_troubles.overwritten_attribute(node_name)
    return (
        f'its class assigns to `self.{attribute}`: `Node` already has an attribute of this name, '
        'and uses it, so choose another name'
        if attribute
        else ''
    )


def what_ended_a_thread() -> str:
    """A clause about the exception of a thread that the notebook itself has started, or ''.

    An executor of the student's may have spun there: then the callbacks of its nodes have stopped.
    """
    said = node_troubles.last_raised(wire.THREADS)
    return f'a thread of the notebook raised {student_exception(said)}' if said else ''


def _why_too_little(names: str) -> str:
    """A hint about a callback whose def has more parameters than rclpy gives it values."""
    if "'self'" in names:
        return ', so give a method as self. and its name, and not as the class and its name'
    return f', so leave {names} out of its def: it is called without'
