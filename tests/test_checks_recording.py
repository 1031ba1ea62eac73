"""What a recording says of its messages: names, positions, frames and stamps."""

import math

import pytest
from geometry_msgs.msg import Point
from made_recordings import START_SEC, every, joint_state, recording
from my_robot_basics.checks import CheckFailed

LOW, HIGH = (-math.pi / 2, -2.1), (math.pi / 2, 2.1)


@pytest.mark.parametrize(
    ('angle', 'seen'),
    [
        (lambda time_sec: 0.4 * time_sec, 'further out with each message: turn back'),
        (lambda time_sec: -90.0 + 10 * time_sec, 'further out with each message: turn back'),
        (lambda time_sec: 90.0 * math.sin(time_sec), 'which looks like degrees'),
    ],
)
def test_an_ever_growing_angle_is_distinguished_from_degrees(angle, seen):
    made = recording(message=lambda time_sec: joint_state(time_sec, position=[angle(time_sec), 0]))
    with pytest.raises(CheckFailed, match=seen):
        made.assert_positions_rad(low=LOW, high=HIGH)


def test_a_joint_limit_rounded_to_three_decimals_passes():
    right_angle = math.pi / 2
    for angle in right_angle, 1.5708, 1.571, -1.571:
        made = recording(
            message=lambda time_sec, at=angle: joint_state(time_sec, position=[at, 0])
        )
        made.assert_positions_rad(low=LOW, high=HIGH)
    beyond = recording(message=lambda time_sec: joint_state(time_sec, position=[1.58, 0]))
    with pytest.raises(
        CheckFailed, match=r'\(-1.571 to 1.571, .*saw \(1.58, 0\): keep each joint'
    ):
        beyond.assert_positions_rad(low=LOW, high=HIGH)


def swapped(time_sec):
    return joint_state(time_sec, name=['joint2', 'joint1'], position=[2.0, 1.5])


def test_names_may_come_in_any_order_with_their_positions():
    made = recording(message=swapped)
    made.assert_joint_names(('joint1', 'joint2'))
    made.assert_positions_rad(low=LOW, high=HIGH, names=('joint1', 'joint2'))
    with pytest.raises(CheckFailed):
        made.assert_positions_rad(low=LOW, high=HIGH)


MESSAGES = {
    'wrong names': ({'name': ['joint_1', 'joint_2']}, "saw 'joint_1', 'joint_2'"),
    'no names': ({'name': []}, "expected the joint names 'joint1', 'joint2', saw none"),
    'one name': ({'name': ['joint1']}, "saw 'joint1'"),
    'both in one text': ({'name': ['joint1, joint2']}, "saw 'joint1, joint2': "),
    'a space behind': ({'name': ['joint1 ', 'joint2']}, "saw 'joint1 ', 'joint2'"),
    'degrees': ({'position': [23.4, -67.8]}, r'saw \(23.4, -67.8\), which looks like degrees'),
    'more than degrees': ({'position': [1340.7, -3884.7]}, r'too large .*: call radians\(\)'),
    'out of range': ({'position': [0.1, 200.0]}, 'keep each joint within its range'),
    'a whole turn in radians': ({'position': [4.5, 6.2]}, 'keep each joint within its range'),
    'not a number': ({'position': [math.nan, 0.0]}, r'saw \(nan, 0\)'),
    'no position': ({'position': []}, 'expected 2 positions in each message, saw 0'),
    'three positions': ({'position': [0.0] * 3}, 'saw 3'),
    'other frame': ({'frame_id': 'world'}, "expected frame_id 'base_link', saw 'world'"),
    'frame and a space': ({'frame_id': 'base_link '}, "saw 'base_link '"),
    'no stamp': ({'stamp': 0.0}, 'saw a stamp of 0'),
    'one stamp': ({'stamp': START_SEC}, 'saw a stamp that does not advance'),
}


@pytest.mark.parametrize(('changes', 'reason'), MESSAGES.values(), ids=MESSAGES)
@pytest.mark.parametrize('clock', ['simulated', 'wall'])
def test_a_wrong_message_is_explained(clock, changes, reason):
    def message(time_sec):
        rest = {k: v for k, v in changes.items() if k != 'frame_id'}
        made = joint_state(time_sec, **rest)
        made.header.frame_id = changes.get('frame_id', 'base_link')
        return made

    def check(made):
        made.assert_joint_names(('joint1', 'joint2'))
        made.assert_positions_rad(low=LOW, high=HIGH)
        made.assert_frame_id('base_link')
        made.assert_stamps()

    check(recording(clock=clock))
    with pytest.raises(CheckFailed, match=reason):
        check(recording(clock=clock, message=message))


@pytest.mark.parametrize(
    ('clock', 'off_sec', 'passes'),
    [
        ('simulated', 0.1, True),
        ('simulated', -0.1, True),
        # the stamp of the message before
        ('simulated', -0.2, False),
        ('simulated', 0.7, False),
        ('simulated', -8.0, False),
        ('wall', -0.1, True),
        ('wall', -0.2, False),
        ('wall', -1.2, False),
    ],
)
def test_a_stamp_is_near_the_clock(clock, off_sec, passes):
    made = recording(
        clock=clock, message=lambda time: joint_state(time, stamp=START_SEC + time + off_sec)
    )
    if passes:
        made.assert_stamps()
    else:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        with pytest.raises(CheckFailed, match=rf'a stamp {abs(off_sec)} s {side} it: set'):
            made.assert_stamps()


@pytest.mark.parametrize('clock', ['simulated', 'wall'])
def test_two_messages_at_once_with_one_stamp_are_reported_as_such(clock):
    twice = [time for time in every(0.2) for _ in range(2)]
    with pytest.raises(CheckFailed, match='two messages at once with the same stamp: publish one'):
        recording(twice, clock=clock).assert_stamps()


@pytest.mark.parametrize(
    ('clock', 'off_sec', 'passes'),
    [
        ('simulated', -0.3, True),
        ('simulated', -0.7, False),
        ('wall', -0.7, True),
        ('wall', 1.2, False),
    ],
)
def test_one_stamp_may_be_off_up_to_a_limit(clock, off_sec, passes):
    def one_late(time):
        return joint_state(time, stamp=START_SEC + time + (off_sec if time == 4.0 else 0.0))

    made = recording(every(2.0, 10), clock=clock, message=one_late)
    if passes:
        made.assert_stamps()
    else:
        side = 'ahead of' if off_sec > 0.0 else 'behind'
        with pytest.raises(CheckFailed, match=f'a stamp {abs(off_sec)} s {side} it'):
            made.assert_stamps()


def test_messages_of_another_type_are_named():
    made = recording(message=lambda time: Point())
    with pytest.raises(CheckFailed, match='expected messages with a name on /t, saw Point'):
        made.assert_joint_names(('joint1', 'joint2'))


@pytest.mark.starts
@pytest.mark.parametrize('assertion', ['assert_joint_names', 'assert_frame_id', 'assert_stamps'])
def test_assertions_fail_without_any_message(assertion):
    arguments = {'assert_joint_names': [('joint1',)], 'assert_frame_id': ['base_link']}
    with pytest.raises(CheckFailed, match='expected messages on /t, saw none'):
        getattr(recording([]), assertion)(*arguments.get(assertion, []))
