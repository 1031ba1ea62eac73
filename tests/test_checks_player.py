"""A program that visits targets: right in several ways, and with the cause if it is wrong."""

import contextlib
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed, player
from my_robot_basics.checks.packages import drawing, player_meeting, player_report
from my_robot_basics.feedback.errors import Starved, fail
from my_robot_basics.session import pressure

PLAYERS = Path(__file__).parent / 'nodes/players.py'
VISIBLE = (
    ('succeeded', 1.2, 0.8),
    ('unreachable', 3.0, 1.0),
    ('canceled', 0.5, -1.1),
    ('succeeded', -0.6, 0.9),
)
"""What the grade cell `arm_player_plays` shows."""


class StandIn:
    """Runs the program instead of the executable of a package, which would have to be built."""

    def __init__(self, variant, parameters):
        targets = ', '.join(map(repr, parameters['targets']))
        command = [sys.executable, PLAYERS, variant, '--ros-args', '-p', f'targets:=[{targets}]']
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, encoding='utf-8'
        )

    def expect_running(self):
        if self.process.poll() is not None:
            said = self.process.stderr.read().strip().splitlines()
            fail(expected='it to run', seen=f'it ended: {said[-1:]}', hint='fix that first')

    def end(self):
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(5.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stderr.close()


@pytest.fixture
def play(monkeypatch):
    """Let one of the programs be `arm_player`, and check it."""
    monkeypatch.setattr(drawing, 'REPLY_SEC', 1.5)
    monkeypatch.setattr(player_report, 'LATE_SEC', 1.5)

    def play(variant, targets, **options):
        @contextlib.contextmanager
        def run(name, *, parameters):
            assert name == 'arm_player'
            process = StandIn(variant, parameters)
            try:
                yield process
            finally:
                process.end()

        package = type('Package', (), {'run': staticmethod(run)})
        monkeypatch.setattr(drawing, 'package', lambda _: package)
        player.expect_plays(*targets, **options)

    return play


def pretend(monkeypatch, *, busy_part):
    """Let processes wait for a processor for that part of the time, as Linux reports it."""
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: busy_part * time.monotonic())
    monkeypatch.setattr(pressure, 'idle_sec', time.monotonic)


RIGHT = (
    *('Usual', 'Callbacks', 'Awaits', 'Threads', 'BlocksInAGroup', 'AsksAhead'),
    'MakesThemLate',
)


@pytest.mark.parametrize('variant', RIGHT)
def test_each_correct_way_to_visit_targets_passes(play, variant):
    play(variant, VISIBLE, first_goal_sec=1.5)
    play(variant, player.choose(random.Random(5)), arm_first=True)


WRONG = {
    'StopsAtTheFirstUnreachable': 'reachable is False, note it and go on',
    'RaisesAtAnUnreachable': 'it ended: .*ValueError',
    'GivesUpWhenCanceled': 'goal that was canceled has a result',
    'SendsAllGoalsAtOnce': 'send the next goal when the result of the one before is there',
    'ReportsBeforeTheEnd': 'publish one report, when the result of the last goal is there',
    'ReportsEachTarget': 'publish one report, when the result of the last goal is there',
    'CallsInACallback': 'inside a callback and waited there',
    'NeverWaitsForTheServer': 'wait (until there is a server|for both servers first)',
    'NeverWaitsForTheArm': 'no request to /solve_ik while there is no /move_arm yet, saw one',
    'ElbowDown': 'this is elbow_down',
    'SolvesItself': 'not a solution of your own',
    'OtherSpeed': 'the speed that the task names',
    'SwapsXAndY': 'copy both to the request',
    'FixedTargets': 'the parameter targets is x1, y1, x2, y2',
    'AlwaysSucceeded': 'the status of the result tells',
    'SaysCancelled': 'write the words as the task does',
    'Volatile': 'durability TRANSIENT_LOCAL',
    'EndsAfterTheReport': 'it ended|until Ctrl-C',
    'AnotherTopic': '/arm_player uses /done, so compare the spelling',
}


@pytest.mark.parametrize('variant', WRONG)
def test_each_wrong_program_fails_with_its_cause(play, variant):
    targets = [('succeeded', 0.9, -0.7), *VISIBLE[1:]] if variant == 'FixedTargets' else VISIBLE
    with pytest.raises(CheckFailed, match=WRONG[variant]):
        play(variant, targets)


def test_a_node_that_ends_soon_after_its_report_fails(play):
    with pytest.raises(CheckFailed, match='it ended'):
        play('SleepsAfterTheReport', VISIBLE, stays_sec=player_report.STAYS_SEC)


@pytest.mark.parametrize(
    ('seen', 'advice'),
    [
        (['succeededunreachable'], 'write these words alone, with a space between'),
        (['1:succeeded', '2:unreachable'], 'write these words alone, with a space between'),
        (['succeeded', 'done'], 'write these words alone, with a space between'),
        (['Succeeded', 'Unreachable'], 'write the words as the task does'),
        (['succeeded'], 'report on every target, in one message'),
        (['unreachable', 'succeeded'], 'one word for each target, in their order'),
    ],
)
def test_advice_about_a_wrong_report_fits_its_words(seen, advice):
    assert player_report._why_wrong(seen, ['succeeded', 'unreachable']).startswith(advice)


def test_a_program_that_does_not_wait_for_the_solver_fails(play):
    with pytest.raises(CheckFailed, match='wait until there is a server'):
        play('NeverWaitsForTheSolver', VISIBLE, arm_first=True)


@pytest.mark.parametrize(
    ('targets', 'words'),
    [
        (VISIBLE, 'send the next goal when the result of the one before is there'),
        (VISIBLE[1:3], 'publish one report, when the result of the last goal is there'),
    ],
)
def test_a_program_that_gives_up_a_goal_after_a_second_fails(play, targets, words):
    with pytest.raises(CheckFailed, match=words):
        play('GivesUpAfterASecond', targets, first_goal_sec=3.0)


@pytest.mark.parametrize(
    ('variant', 'options'),
    [
        ('GivesUpAfterFiveSeconds', {'first_goal_sec': 3.0}),
        ('WaitsFiveSecondsForTheSolver', {'arm_first': True}),
        ('SleepsFiveSecondsAfterTheReport', {'stays_sec': player_report.STAYS_SEC}),
    ],
)
def test_a_limit_of_five_seconds_in_a_program_is_not_exceeded_on_a_busy_machine(
    play, monkeypatch, variant, options
):
    """It is not on an idle one, and a program measures the wall time."""
    pretend(monkeypatch, busy_part=0.8)
    play(variant, VISIBLE[:1], **options)


def test_a_program_that_waits_a_second_for_the_arm_fails_on_an_idle_machine(play, monkeypatch):
    pretend(monkeypatch, busy_part=0.0)
    with pytest.raises(CheckFailed, match='no request to /solve_ik while there is no /move_arm'):
        play('WaitsASecondForTheArm', VISIBLE)


def test_a_program_that_waits_for_the_result_of_a_rejected_goal_fails(play):
    targets = [('succeeded', 1.2, 0.8), ('rejected', 0.9, -0.9), ('succeeded', -0.6, 0.9)]
    with pytest.raises(CheckFailed, match=r'is not accepted has no result|it ended'):
        play('WaitsForARejectedGoal', targets)


def test_chosen_targets_cover_each_outcome_and_repeat_one():
    targets = player.choose(random.Random(1))
    assert {word for word, _, _ in targets} == set(
        drawing.PlayerServers.__init__.__globals__['WORDS']
    )
    assert len({*targets}) == len(targets) - 1
    assert targets[-1] in targets[:-2]  # one is listed twice, and not side by side


def test_an_unknown_word_is_refused():
    with pytest.raises(ValueError, match='not late'):
        player.expect_plays(('late', 1.0, 1.0))


@pytest.mark.parametrize(('free_sec', 'doubt'), [(8.0, CheckFailed), (1.0, Starved)])
def test_a_missing_client_counts_as_starved_on_a_busy_machine(monkeypatch, free_sec, doubt):
    """It had no client after eight seconds on the wall clock, and most of them were not free."""
    monkeypatch.setattr(player_meeting, 'expect_no_other', lambda *_, own, stop: None)
    monkeypatch.setattr(player_meeting.drawing_hints, 'why_no_client', lambda watcher: 'look')
    watch = SimpleNamespace(free_sec=lambda: free_sec)
    monkeypatch.setattr(player_meeting, 'Stopwatch', lambda: watch)
    watcher = SimpleNamespace(
        node=SimpleNamespace(count_clients=lambda name: 0),
        spin_until_free=lambda done, free_sec: done(),
    )
    process = SimpleNamespace(expect_running=lambda: None)
    with pytest.raises(CheckFailed, match='a client of /solve_ik, saw none: look') as raised:
        player_meeting.PlayerMeeting(watcher, process).wait_for_clients()
    assert raised.type is doubt
