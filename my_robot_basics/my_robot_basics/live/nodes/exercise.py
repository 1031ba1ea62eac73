"""For the locked cells of an exercise: `reset` before the answer, `run_answer` after it."""

import sys
from typing import Any

import psutil
from rclpy.node import Node

from my_robot_basics.live.nodes import answer_end, course_nodes, outdated, runner, unawaited
from my_robot_basics.live.output import troubles
from my_robot_basics.live.packages import commands
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable, tell
from my_robot_basics.session.neighbours import nodes_here

_started_before: set[psutil.Process] = set()
"""Processes from before the answer: the lesson's own cells may start the course's nodes."""


def reset(*names: str) -> None:
    """Stop every node, shut rclpy down, and delete `names` from the notebook's variables.

    So nothing from earlier cells counts as an answer, and an answer may initialise rclpy itself.
    At grading, the course's own nodes cannot be used from then on, either.
    """
    runner.shut_down()
    troubles.forget_all()
    answer_end.watch_answer('')
    if classroom.in_grading_room():
        course_nodes.refuse_course_nodes_for_good()
    _started_before.clear()
    _started_before.update(psutil.Process().children())
    for name in names:
        _notebook().pop(name, None)
    if names:
        tell(f'reset: no node is running; now write {", ".join(names)}')
    else:
        tell('reset: no node is running')


def run_answer(name: str, *args: Any, **kwargs: Any) -> Node | None:
    """Run the node class `name` that the answer cell defines; see `run` for the rest.

    Raises NotRunnable if the notebook has no such class derived from Node, if it was imported or
    taken from the course's own nodes, if the answer has started the program of one of these, or
    if it has created its node already, but does not spin it.
    """
    __tracebackhide__ = True
    answer = _notebook().get(name)
    where = 'write it in the answer cell: only the notebook is submitted'
    if answer is None:
        first = 'run the answer cell, and if that ends in an error, fix that first'
        raise NotRunnable(f'expected a class {name}, saw nothing of that name: {first}')
    if not (isinstance(answer, type) and issubclass(answer, Node)):
        is_class, type_name = isinstance(answer, type), type(answer).__name__
        kind = 'one that is not' if is_class else f'an object of type {type_name}'
        wanted = f'expected {name} to be a class derived from Node'
        raise NotRunnable(f'{wanted}, saw {kind}: begin it with `class {name}(Node):`')
    if answer.__module__ != '__main__':
        raise NotRunnable(f'expected your own {name}, saw that of {answer.__module__}: {where}')
    if taken := course_nodes.course_part_of(answer):
        raise NotRunnable(f'expected {name} to be your own, saw {taken}: {course_nodes.HOW}')
    answer_end.watch_answer(answer.__name__)
    outdated.watch()
    unawaited.watch()
    with course_nodes.refuse_course_nodes():
        node = runner.run(answer, *args, **kwargs)
    _refuse_programs()
    if node is None:
        _expect_no_idle_node(answer)
    return node


def _refuse_programs() -> None:
    """End programs of the course's nodes that the answer has started, and raise NotRunnable."""
    started = course_nodes.programs(besides=_started_before | _of_another_exercise())
    if started:
        course_nodes.end_programs(started)
        name = min(started.values())
        raise NotRunnable(
            f"expected a node of your own, saw the course's program {name} started:"
            f' {course_nodes.HOW}'
        )


def _of_another_exercise() -> set[psutil.Process]:
    """The processes of `run_commands`, if a student has gone back to the exercise before it.

    When answers are judged, each exercise has processes of its own: there is none of another.
    """
    if classroom.in_grading_room():
        return set()
    pids = commands.pids()
    return {child for child in psutil.Process().children() if child.pid in pids}


def _expect_no_idle_node(answer: type[Node]) -> None:
    """Raise NotRunnable if a cell has made a node of the answer that nothing spins."""
    idle = [node for node in nodes_here() if node.executor is None]
    if any(isinstance(node, answer) for node in idle):
        raise NotRunnable(
            f'expected the class {answer.__name__} alone, saw a node of it that nothing spins: '
            'leave out the line that makes it, because this cell makes one, and spins it'
        )
    # once the cell has run again without that line, the class is another one
    if any(type(node).__name__ == answer.__name__ for node in idle):
        raise NotRunnable(
            f'expected the class {answer.__name__} alone, saw a node of it from before it was '
            'changed: run the cell with reset(…), then the answer cell, then this one'
        )


def _notebook() -> dict[str, Any]:
    return vars(sys.modules['__main__'])
