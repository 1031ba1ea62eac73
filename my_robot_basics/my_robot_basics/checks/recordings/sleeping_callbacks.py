"""Name a sleep in a callback, if a node is slower than it should be."""

from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.hidden import student_text


def why_too_slow(recording: RecordedMessages, wanted_hz: float) -> str:
    """What to try if a callback sleeps, and the rate is too low; '' if that is not the cause.

    On the robot's clock, each tick waits for callbacks: there, the cause is another one.
    """
    if recording.clock != 'wall' or recording.rate_hz >= wanted_hz:
        return ''
    number, text = node_troubles.sleeping_line()
    if not text:
        return ''
    line_number, call = map(student_text, (number, text))
    return (
        f'a callback sleeps in line {line_number} ({call}), and meanwhile the timer cannot call '
        'anything: leave the sleep out'
    )
