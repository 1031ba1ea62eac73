"""Student files are read in a process with limits."""

import io
import json
import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict

import pytest
from my_robot_basics.language.catalogues import LOCALE, languages

from grader.common import parsing, parsing_process
from grader.common.errors import CourseError
from grader.common.parsing import Limits, ParsingFailed, parse
from grader.report import page

SHORT = Limits(cpu_sec=1, wall_sec=60)


def test_an_answer_comes_back_as_json():
    assert parse('json:loads', '{"ä": [1, 2.5, null, "\\udcff"]}') == {
        'ä': [1, 2.5, None, '\udcff']
    }
    assert parse('os:getpid') != os.getpid()


def test_the_output_of_a_reader_is_not_taken_as_its_answer():
    assert parse('builtins:print', '{"answer": 1}') is None


@pytest.mark.parametrize(
    ('question', 'why'),
    [
        (('re:fullmatch', '(a+)+b', 'a' * 60), 'it takes over 1 s of processor time'),
        (('operator:mul', 'a', 10**10), 'it takes too much memory'),
        (('json:loads', '[' * 100_000), 'it is nested too deep'),
        (('json:loads', '{'), 'JSONDecodeError: Expecting property name'),
        (('os:abort',), r'the program that reads such files crashed on it \(6\)'),
        (('os:_exit', 3), r'the program that reads such files crashed on it \(-3\)'),
        (('builtins:object',), 'TypeError: Object of type object is not JSON serializable'),
    ],
)
def test_a_question_that_fails_does_not_affect_the_next_question(question, why):
    with pytest.raises(ParsingFailed, match=why):
        parse(*question, limits=SHORT)
    assert parse('json:loads', '1') == 1


def test_a_question_that_waits_for_ever_ends_at_the_time_limit():
    with pytest.raises(ParsingFailed, match=r'it takes over 1 s$'):
        parse('time:sleep', 1_000, limits=Limits(wall_sec=1))


def test_an_answer_that_is_too_long_is_refused(monkeypatch):
    with pytest.raises(ParsingFailed, match='too long an answer'):
        parse('operator:mul', 'a', parsing.MAX_ANSWER_BYTES + 1)


@pytest.mark.starts
def test_a_too_long_answer_of_a_process_that_has_ended_is_refused(monkeypatch):
    """If the rest of the answer fits into the pipe, the process ends without a signal."""
    monkeypatch.setattr(parsing_process, 'MAX_ANSWER_BYTES', 10)
    monkeypatch.setattr(os, 'kill', lambda *_: None)
    answers = io.BytesIO()
    question = json.dumps(['operator:mul', ['a', 100], asdict(Limits())]).encode() + b'\n'
    parsing_process.serve(io.BytesIO(question), answers)
    assert 'too long an answer' in json.loads(answers.getvalue())['why']


def test_an_error_of_the_operating_system_is_not_blamed_on_the_text():
    with pytest.raises(FileNotFoundError):
        parse('os:listdir', '/nowhere')


@pytest.mark.skipif(parsing.AT_ONCE < 2, reason='one processor: one question at a time')
def test_two_questions_are_answered_at_the_same_time(tmp_path):
    """Each end of a FIFO is open once the other one is."""
    os.mkfifo(tmp_path / 'fifo')
    with ThreadPoolExecutor(2) as threads:
        ends = [
            threads.submit(
                parse, 'os:open', str(tmp_path / 'fifo'), flags, limits=Limits(wall_sec=20)
            )
            for flags in (os.O_RDONLY, os.O_WRONLY)
        ]
        assert all(isinstance(end.result(), int) for end in ends)


def test_a_cancelled_question_ends_and_the_next_question_is_answered():
    with ThreadPoolExecutor(1) as threads:
        waiting = threads.submit(parse, 'time:sleep', 60, limits=Limits(wall_sec=20))
        while not parsing._SERVERS._busy:
            time.sleep(0.01)
        parsing.cancel_requests()
        with pytest.raises((CourseError, BrokenPipeError)):
            waiting.result()
    assert parse('json:loads', '1') == 1


def test_page_templates_of_all_languages_are_loaded_once():
    page._template.cache_clear()
    for _ in range(2):
        assert parsing_process._function('grader.report.page:render_page') is page.render_page
    assert page._template.cache_info().misses == 1 + len(languages(LOCALE))
    page._template.cache_clear()


def test_several_threads_receive_the_answers_to_their_own_questions():
    found = {}
    threads = [
        threading.Thread(target=lambda n=n: found.update({n: parse('operator:neg', n)}))
        for n in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {n: -n for n in range(8)}


def test_an_ended_parsing_process_is_an_error_of_the_course_and_is_replaced(monkeypatch):
    monkeypatch.setattr(parsing, 'COMMAND', ('true',))
    server = parsing._Server()
    with pytest.raises((CourseError, BrokenPipeError)):
        server.ask('json:loads', ['1'], Limits())
    monkeypatch.undo()
    assert server.ask('json:loads', ['1'], Limits()) == 1
    server.end()
