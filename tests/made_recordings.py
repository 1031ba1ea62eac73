"""Recordings made for tests: messages at chosen times, as a check would have recorded them."""

import math

from builtin_interfaces.msg import Time
from my_robot_basics.checks.recordings.recorded_messages import Sample
from my_robot_basics.checks.recordings.recording import Recording
from sensor_msgs.msg import JointState

START_SEC = 1000.0


def joint_state(time_sec, **changes):
    message = JointState(name=['joint1', 'joint2'], position=[0.5, -1.0])
    message.header.frame_id = 'base_link'
    stamp = changes.pop('stamp', START_SEC + time_sec)
    message.header.stamp = Time(sec=int(stamp), nanosec=round(stamp % 1 * 1e9))
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def recording(times=None, *, clock='simulated', message=joint_state, **changes):
    times = [0.2 * i for i in range(1, 51)] if times is None else times
    samples = (Sample(message(time), time, START_SEC + time) for time in times)
    seconds = times[-1] if clock == 'wall' and times else 10.0
    fields = {'publishers': ('/a',), 'seconds': seconds, 'start_sec': START_SEC, 'step_sec': 0.1}
    fields |= changes
    return Recording(topic_name='/t', messages=tuple(samples), clock=clock, **fields)


def every(period_sec, count=50):
    return [period_sec * i for i in range(1, count + 1)]


def ticked(period_sec, seconds, step_sec, *, late=()):
    """Return when a timer's messages are seen on a clock that moves in steps; some a step late."""
    count = int(seconds / period_sec)
    ticks = [math.ceil(period_sec * i / step_sec - 1e-9) + (i in late) for i in range(1, count)]
    return [step_sec * tick for tick in ticks]


def on_wall(gaps_sec, *, late_sec):
    """Return a recording on the wall clock with these gaps between messages, of any content."""
    times = [sum(gaps_sec[:n]) for n in range(1, len(gaps_sec) + 1)]
    samples = tuple(Sample(None, at, at) for at in times)
    return Recording(
        topic_name='/t',
        messages=samples,
        clock='wall',
        publishers=('/a',),
        seconds=times[-1],
        start_sec=0.0,
        late_sec=late_sec,
    )
