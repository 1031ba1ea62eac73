"""When a check uses the recording of an earlier check, and when it makes its own."""

from dataclasses import replace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.recordings.recorded_messages import Sample
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics import earlier_looks
from my_robot_basics.checks.topics.earlier_looks import Look, Wanted, look_once
from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.errors import Starved, fail
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import interactions


@pytest.fixture(autouse=True)
def test_room(monkeypatch):
    monkeypatch.setattr(earlier_looks, '_last', None)
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')


class Topic:
    """A topic on which one message comes each 0.2 s; counts the looks."""

    def __init__(self, **of_recording):
        self.looks = 0
        self._of_recording = {'clock': 'simulated', 'step_sec': 0.1} | of_recording

    def record(self, seconds, *, name='/t', step_sec=0.1):
        def look(earlier):
            self.earlier = earlier
            self.looks += 1
            samples = (Sample(f'{i}', 0.2 * i, 0.2 * i) for i in range(1, round(5 * seconds) + 1))
            recording = Recording(
                topic_name=name,
                messages=tuple(samples),
                publishers=('/a',),
                seconds=seconds,
                start_sec=0.0,
                **self._of_recording,
            )
            return Look(recording, None)

        return look_once(Wanted(name, seconds, step_sec), look).recording


def test_a_shorter_recording_is_the_beginning_of_a_longer_one():
    topic = Topic()
    assert len(topic.record(60.0).messages) == 300
    shorter = topic.record(10.0)
    assert topic.looks == 1
    assert (len(shorter.messages), shorter.seconds) == (50, 10.0)
    assert topic.record(40.0).messages[-1].time_sec == 40.0


def test_a_shorter_recording_of_rare_messages_has_the_first_two():
    samples = (Sample('first', 20.0, 20.0), Sample('second', 40.0, 40.0))
    rare = Recording(
        topic_name='/t',
        messages=samples,
        clock='simulated',
        publishers=('/a',),
        seconds=60.0,
        start_sec=0.0,
    )
    look_once(Wanted('/t', 60.0, 0.1), lambda _: Look(rare, None))
    found = look_once(Wanted('/t', 10.0, 0.1), lambda _: None)
    assert (found.recording.messages, found.recording.seconds) == (samples, 40.0)


@pytest.mark.parametrize('clock', ['simulated', 'wall'])
def test_a_longer_recording_is_made_anew(clock):
    topic = Topic(clock=clock)
    topic.record(10.0), topic.record(60.0), topic.record(60.0)
    assert topic.looks == 2


def test_a_longer_look_on_the_wall_clock_receives_the_earlier_recording():
    topic = Topic(clock='wall')
    shorter = topic.record(10.0)
    topic.record(60.0)
    assert topic.earlier.recording is shorter
    interactions.note()
    topic.record(90.0)
    assert topic.earlier is None


def test_a_longer_look_on_the_simulated_clock_receives_no_earlier_recording():
    topic = Topic()
    topic.record(10.0), topic.record(60.0)
    assert topic.earlier is None


@pytest.mark.parametrize('differs', [{'name': '/other'}, {'step_sec': 0.02}])
def test_another_topic_or_step_is_recorded_anew(differs):
    topic = Topic()
    topic.record(10.0), topic.record(10.0, **differs)
    assert topic.looks == 2


def test_a_topic_whose_messages_ended_is_recorded_again():
    topic = Topic(clock='wall')
    samples = tuple(Sample('one', 0.2 * i, 0.2 * i) for i in range(1, 11))
    ended = replace(topic.record(10.0), messages=samples, seconds=4.0)
    look_once(Wanted('/ended', 10.0, 0.1), lambda _: Look(ended, None))
    topic.record(10.0, name='/ended')
    assert topic.looks == 2


def test_a_makeshift_recording_is_not_used_again():
    topic = Topic(clock='wall', is_makeshift=True)
    topic.record(10.0), topic.record(10.0)
    assert topic.looks == 2


def test_recordings_are_not_reused_outside_the_test_room(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM')
    topic = Topic()
    topic.record(10.0), topic.record(10.0)
    assert topic.looks == 2


def test_an_interaction_with_nodes_causes_a_new_recording():
    topic = Topic()
    topic.record(10.0)
    interactions.note()
    topic.record(10.0)
    assert topic.looks == 2


@pytest.mark.starts
@pytest.mark.parametrize(('listens', 'counted'), [(True, 0), (False, 1)])
def test_a_watcher_counts_as_an_interaction_unless_it_only_listens(listens, counted):
    before = interactions.count()
    with Watcher(listens=listens):
        pass
    assert interactions.count() - before == counted


def nothing(**doubt):
    fail(expected='messages on /t', seen='no message in 7 s', hint='publish some', **doubt)


def test_silence_is_reported_again_and_only_by_its_cause_in_a_hidden_check(monkeypatch):
    wanted, looks = Wanted('/t', 10.0, 0.1), []

    def look(_):
        looks.append(1)
        nothing(cause='nothing comes')

    with pytest.raises(CheckFailed, match='saw no message in 7 s: publish some'):
        look_once(wanted, look)
    monkeypatch.setattr(hidden, '_quiet', True)
    with pytest.raises(CheckFailed, match=f'{hidden.PLACE}nothing comes: publish some'):
        look_once(wanted, look)
    assert len(looks) == 1


def test_a_failure_that_the_machine_may_have_caused_is_checked_again():
    looks = []

    def look(_):
        looks.append(1)
        nothing(doubt=Starved)

    for _ in range(2):
        with pytest.raises(Starved):
            look_once(Wanted('/t', 10.0, 0.1), look)
    assert len(looks) == 2
