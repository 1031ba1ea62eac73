"""Why the log of a node lacks a record, as far as the notebook's process can tell: hints only."""

from my_robot_basics.checks.nodes.node_log import NodeLog
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.stop_reasons import what_has_not_returned, what_stopped

_SEVERITIES = {'INFO': 20, 'WARN': 30}


def why_unlogged(log: NodeLog, level: str) -> str:
    """A clause on what keeps the answer to the last target out of the log; or ''.

    A callback sleeps, has not returned, or raised before any INFO; or the logger drops the level.
    A ValueError in place of a warning is left out: it has to be caught, which is other advice.
    """
    if log.wait.slept_in[1]:
        line_number, call = map(student_text, log.wait.slept_in)
        return (
            f'a callback sleeps in line {line_number} ({call}), so the answer comes too late: '
            'leave the sleep out'
        )
    names = [log.node_name]
    is_silent = level == 'WARN' or not log.has('INFO')
    why = what_stopped(names) if is_silent else what_has_not_returned(names)
    if why and (level != 'WARN' or 'ValueError' not in why or 'severity' in why):
        return f'{why}; fix that first'
    if node_troubles.logger_level(log.node_name) > _SEVERITIES[level]:
        return (
            f'the logger of this node drops {level} records, so leave set_level(…) out, or give it'
            f' LoggingSeverity.{level}'
        )
    return ''
