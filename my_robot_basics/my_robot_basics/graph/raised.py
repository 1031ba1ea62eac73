"""What stopped a node: an exception of a callback or thread, or a callback that never returns."""

from collections.abc import Iterable

from my_robot_basics.exchange import node_troubles, wire
from my_robot_basics.feedback.hidden import raised as safely
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.feedback.python_errors import explained, what_to_do


def what_raised(node_names: Iterable[str]) -> str:
    """A clause about the exception of a callback of one of the nodes, or ''."""
    raised = ((name, node_troubles.last_raised(name)) for name in sorted(set(node_names)))
    name, said = next((each for each in raised if each[1]), ('', ''))
    if not said:
        return ''
    why = f'its callback raised {safely(said)}'
    if said.endswith('object is not callable') and not what_to_do(said):
        why += ', so give a method by its name, without parentheses'
    field, type_name = node_troubles.unpublished_field(name)
    if "'Time' object has no attribute 'sec'" in said:
        why += ', so make a stamp of the time with .to_msg()'
    elif field:
        where, kind = theirs(field), theirs(type_name)
        why += f', so give `{where}` a value of the type `{kind}`'
    elif type_name:
        why += f', so what you give it has to be made with `{theirs(type_name)}`'
    elif 'bad argument type for built-in operation' in said:
        why += ', so a field of the message holds a value of another type'
    return explained(why)


def what_stopped(node_names: Iterable[str]) -> str:
    """The same, else a clause about an unfinished callback or a thread that raised, or ''."""
    names = sorted(set(node_names))
    if raised := what_raised(names):
        return raised
    said = next(filter(None, map(node_troubles.unfinished, names)), '')
    return f'its callback has not returned ({theirs(said)})' if said else what_ended_a_thread()


def what_ended_a_thread() -> str:
    """A clause about the exception of a thread that the notebook itself has started, or ''.

    An executor of the student's may have spun there: then the callbacks of its nodes have stopped.
    """
    said = node_troubles.last_raised(wire.THREADS)
    return f'a thread of the notebook raised {safely(said)}' if said else ''
