"""What `ros2 action` prints of a running system: the cases of ros2cli's own tests (Jazzy)."""

import contextlib
import re
import signal

import pytest
from ros2_command import SCRIPT, TIMEOUT_SEC, on_the_graph, own_domain, ros2, started

KIND = 'arm_interfaces/action/MoveArm'
ACTION, HIDDEN = '/my_ns/move_arm', '/my_ns/_move_arm'
WAITING = 'Waiting for an action server to become available...\n'


@pytest.fixture(scope='module', autouse=True)
def system():
    with own_domain(), on_the_graph('actions', topics=('/my_ns/_mover_is_up',)):
        yield


def goal(speed):
    return f'{{position: [0.5, -1.0], speed: {speed}}}'


def sent(speed):
    return f'{WAITING}Sending goal:\n     position:\n- 0.5\n- -1.0\nspeed: {speed}\n\n'


def feedback(remaining):
    return f'Feedback:\n    position:\n- 0.5\n- -1.0\nremaining: {remaining}\n\n'


def ended(status):
    return f'Result:\n    position:\n- 0.5\n- -1.0\n\nGoal finished with status: {status}\n'


ACCEPTED = 'Goal accepted with ID: ID\n\n'
INFO = 'Action: /my_ns/move_arm\nAction clients: 0\nAction servers: 1\n'
SHOWN = [
    ('list', f'{HIDDEN}\n{ACTION}\n'),
    ('list -t', f'{HIDDEN} [{KIND}]\n{ACTION} [{KIND}]\n'),
    ('list --show-types', f'{HIDDEN} [{KIND}]\n{ACTION} [{KIND}]\n'),
    ('list -c', '2\n'),
    ('type /my_ns/move_arm', f'{KIND}\n'),
    ('info /my_ns/move_arm', f'{INFO}    /my_ns/mover\n'),
    ('info -t /my_ns/move_arm', f'{INFO}    /my_ns/mover [{KIND}]\n'),
    ('info -c /my_ns/move_arm', INFO),
    ('info my_ns/move_arm', f'{INFO}    /my_ns/mover\n'.replace('/my_ns/m', 'my_ns/m', 1)),
    ('info /nothing', 'Action: /nothing\nAction clients: 0\nAction servers: 0\n'),
]


@pytest.mark.parametrize(('words', 'expected'), SHOWN, ids=[words for words, _ in SHOWN])
def test_action_verbs_print_the_output_of_ros2cli(words, expected):
    result = ros2('action', *words.split())
    assert (result.out, result.err, result.status) == (expected, '', 0)


EMPTY = 'position: []\nspeed: 0.0\n'
GOALS = [
    ((KIND, goal(0.5)), '', sent(0.5) + ACCEPTED + ended('SUCCEEDED')),
    (('arm_interfaces/MoveArm', goal(0.5)), '', sent(0.5) + ACCEPTED + ended('SUCCEEDED')),
    ((KIND, '--stdin'), goal(0.5), sent(0.5) + ACCEPTED + ended('SUCCEEDED')),
    ((KIND, goal(-1.0)), '', sent(-1.0) + ACCEPTED + ended('ABORTED')),
    ((KIND, goal(0.0)), '', f'{sent(0.0)}Goal was rejected.\n'),
    ((KIND,), '', f'{WAITING}Sending goal:\n     {EMPTY}\nGoal was rejected.\n'),
]


@pytest.mark.parametrize(('words', 'stdin', 'expected'), GOALS, ids=[str(g[0]) for g in GOALS])
def test_send_goal_prints_how_its_goal_ended(words, stdin, expected):
    result = ros2('action', 'send_goal', ACTION, *words, stdin=stdin)
    assert without_id(result.out) == expected
    assert (result.err, result.status) == ('', 0)


@pytest.mark.parametrize('option', ['-f', '--feedback'])
def test_feedback_is_shown_as_it_comes(option):
    shown = sent(1.0) + ACCEPTED + ''.join(feedback(left) for left in (2.0, 1.0, 0.0))
    with sending(option, ACTION, KIND, goal(1.0)) as process:
        # the first may be there before the client knows that its goal was accepted
        text = read_until(process, lambda text: len(text) >= len(shown))
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=TIMEOUT_SEC)
    assert sorted(text.splitlines()) == sorted(shown.splitlines())
    assert re.findall(r'remaining: .*', text) == re.findall(r'remaining: .*', shown)
    assert out == f'Canceling goal...\nGoal canceled.\n{ended("CANCELED")}'


def without_id(text):
    return re.sub(r'(?<=ID: )[0-9a-f]{32}\n', 'ID\n', text)


@contextlib.contextmanager
def sending(*words):
    with started(SCRIPT, 'action', 'send_goal', *words) as process:
        yield process


def read_until(process, is_enough):
    """Return the lines that a process prints until they are enough, with ids of goals replaced."""
    text = ''
    while not is_enough(text):
        line = process.stdout.readline()
        assert line, text
        text = without_id(text + line)
    return text


@contextlib.contextmanager
def accepted_goal(speed):
    """A command whose goal was accepted; its output was read up to that line."""
    with sending(ACTION, KIND, goal(speed)) as process:
        read_until(process, lambda text: text.endswith(ACCEPTED))
        yield process


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGHUP])
def test_ctrl_c_cancels_the_goal_and_waits_for_its_end(number):
    with accepted_goal(1.0) as process:
        process.send_signal(number)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (out, err) == (f'Canceling goal...\nGoal canceled.\n{ended("CANCELED")}', '')
    assert process.returncode == 0


def test_a_refused_cancellation_of_a_goal_is_reported():
    with accepted_goal(2.0) as process:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (out, err) == ('Canceling goal...\n', 'Failed to cancel goal\n')
    assert process.returncode == 1


def test_send_goal_waits_for_an_action_server_up_to_its_timeout():
    result = ros2('action', 'send_goal', '/nothing', KIND, '--timeout', '1')
    assert result.out == WAITING
    assert result.err == 'Action server is not available after waiting 1 seconds.\n'
    assert result.status == 1


def test_a_goal_that_ends_within_the_timeout_is_not_cancelled():
    result = ros2('action', 'send_goal', ACTION, KIND, goal(0.5), '--timeout', '600')
    assert without_id(result.out) == sent(0.5) + ACCEPTED + ended('SUCCEEDED')


@pytest.mark.slow  # it waits for 15 s, within which a slow machine accepts a goal
def test_a_goal_that_exceeds_the_timeout_is_cancelled_with_a_message():
    result = ros2('action', 'send_goal', ACTION, KIND, goal(1.0), '--timeout', '15')
    assert without_id(result.out) == f'{sent(1.0)}{ACCEPTED}Canceling goal...\nGoal canceled.\n'
    assert result.err == 'The goal has not ended after waiting 15 seconds.\n'
    assert result.status == 1


def test_a_negative_timeout_is_refused():
    result = ros2('action', 'send_goal', ACTION, KIND, '--timeout', '-1')
    assert result.status == 2


def test_sigterm_ends_send_goal_at_once():
    with accepted_goal(2.0) as process:
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (out, err, process.returncode) == ('', '', signal.SIGTERM)


def test_action_info_counts_and_names_an_action_client():
    with accepted_goal(1.0) as process:
        result = ros2('action', 'info', '-t', ACTION)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=TIMEOUT_SEC)
    client = '    /_ros2cli_send_goal_arm_interfaces_action_MoveArm'
    assert result.out == (
        f'Action: {ACTION}\nAction clients: 1\n{client} [{KIND}]\n'
        f'Action servers: 1\n    /my_ns/mover [{KIND}]\n'
    )


def test_sigint_ends_the_wait_for_an_action_server():
    with sending('/nothing', KIND) as process:
        assert process.stdout.readline() == WAITING
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (out, err, process.returncode) == ('', '', signal.SIGINT)


INVALID = 'The passed action type is invalid'
UNFILLED = 'Failed to populate message fields: '
NO_DICTIONARY = "Value '[1]' is expected to be a dictionary but is a list"
NO_FIELD = "sped: arm_interfaces/action/MoveArm_Goal has no field 'sped': did you mean speed?"
SLASHES = "Invalid topic name: topic name must not contain repeated '/':\n  '//x'\n    ^\n"
REFUSED = [
    ('type /not_an_action', ''),
    ('info //x', SLASHES),
    ('send_goal /x os/path', f'{INVALID}\n'),
    ('send_goal /x nothing', f'{INVALID}\n'),
    ('send_goal /x std_srvs/srv/SetBool', f'{INVALID}\n'),
    ('send_goal /x arm_interfaces/action/Movearm', f'{INVALID}: did you mean {KIND}?\n'),
    (f'send_goal /x {KIND} [1]', f'{UNFILLED}{NO_DICTIONARY}\n'),
    (f'send_goal /x {KIND} {{sped:}}', f'{UNFILLED}{NO_FIELD}\n'),
    (f'send_goal //x {KIND}', SLASHES),
]


@pytest.mark.parametrize(('words', 'complaint'), REFUSED, ids=[words for words, _ in REFUSED])
def test_invalid_action_arguments_are_refused_as_by_ros2cli(words, complaint):
    result = ros2('action', *words.split())
    assert (result.out, result.err, result.status) == ('', complaint, 1)


@pytest.mark.parametrize('words', ['send_goal /x', 'send_goal /x y {} --stdin', 'type', 'info'])
def test_wrong_usage_of_an_action_verb_prints_its_correct_usage(words):
    result = ros2('action', *words.split())
    assert result.err.startswith(f'usage: ros2 action {words.split()[0]} [-h]')
    assert (result.out, result.status) == ('', 2)
