"""Why there is no node at all: a clause that begins with what is missing."""

from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.hidden import student_text

NOT_RUNNING = (
    'the node is not running, so run the cell that starts it and read its output; a node whose'
    ' __init__ raises, waits, loops or spins never runs'
)


def why_not_running() -> str:
    """What to do if no node runs: NOT_RUNNING, unless a cell of the notebook has ended it."""
    ended, by, name = node_troubles.how_answer_ended()
    if by:
        return (
            f'the node of {student_text(ended)} no longer runs, because `run({student_text(by)})`'
            f' has started another node of the name {student_text(name)} and ended the first one,'
            " so derive your class from Node itself, and give it, in super().__init__('…'), a name"
            ' that no other node has'
        )
    if ended:
        return (
            f'the node of {student_text(ended)} no longer runs, because stop(…) was called after'
            ' it was started, so run the cell with run_answer(…) again; if a cell of yours after'
            ' that one calls stop(…), delete that line'
        )
    return NOT_RUNNING
