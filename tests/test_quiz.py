"""The questions of the quizzes: what their programs return, and the replies to a guess."""

import ast
import re

import nbformat
import pytest
from my_robot_basics.live.nodes.runner import stop
from my_robot_basics.quiz import ask
from my_robot_basics.quiz.asking import is_same
from my_robot_basics.quiz.explanations import SERVICES, TOPICS

from grader.authoring.quizzes import QUIZZES, quizzes
from grader.course import ROOT, Course

RETURNED = {
    'late_subscription': [2, 3],
    'full_name': '/pose',
    'joint_order': -1.2,
    'timer_rate': 0.2,
    'not_spun': [0, 1],
    'full_queue': [8, 9, 10],
    'four_threads': 1,
    'counted_ends': [2, 0],
    'asks_for_more': ['BEST_EFFORT'],
    'kept_messages': [3, 4, 5],
    'early_request': False,
    'no_return': [1, None],
    'call_in_callback': [1, None],
    'nobody_agrees': [0, 'succeeded'],
    'forgotten_end': 'aborted',
    'never_looks': 'succeeded',
    'empty_response': [False, 0, ''],
    'whole_number': [False, 20.0],
    'read_once': 5.0,
    'rule_without_effect': '/pose',
}
"""The results are written down only in this file: students find them out."""
ALL = quizzes(Course())
EXPLAINED = {'quiz_topics.ipynb': TOPICS, 'quiz_services.ipynb': SERVICES}
GUESS = re.compile(r'^ask\((\w+), guess=(.+)\)$', re.MULTILINE)

each_quiz = pytest.mark.parametrize('name', QUIZZES)


def sources(name):
    return [cell.source for cell in ALL[name].cells if cell.cell_type == 'code']


def test_each_quiz_is_among_the_quizzes_of_the_course():
    assert [*ALL] == [*QUIZZES]


@each_quiz
def test_a_quiz_has_ten_questions_with_explanations_and_reveals_no_answer(name):
    asked = [found for source in sources(name) for found in GUESS.findall(source)]
    assert [guess for _, guess in asked] == ['...'] * 10
    assert [program for program, _ in asked] == [*EXPLAINED[name]]
    assert all(re.search(r'\(lessons? [\d and]+\)\.$', text) for text in EXPLAINED[name].values())
    assert 15 <= len(ALL[name].cells) <= 40


@each_quiz
def test_each_question_says_what_to_guess_in_few_words(name):
    texts = [cell.source for cell in ALL[name].cells if cell.cell_type == 'markdown']
    questions = [text for text in texts if re.match(r'## \d+ · ', text)]
    assert [int(re.match(r'## (\d+) · ', text)[1]) for text in questions] == [*range(1, 11)]
    assert all('**Guess:**' in text and re.search(r'[Ww]rite ', text) for text in questions)
    assert {text[:40]: n for text in texts if not 20 <= (n := len(text.split())) <= 80} == {}
    lines = [len(source.splitlines()) for source in sources(name)]
    assert max(lines) <= 29


@pytest.mark.slow
@each_quiz
@pytest.mark.starts
def test_a_right_guess_is_confirmed_and_a_wrong_guess_is_explained(name, capsys):
    names: dict = {}
    for source in sources(name):
        asked = GUESS.search(source)
        exec(GUESS.sub('', source), names)
        if asked:
            program, right = names[asked[1]], RETURNED[asked[1]]
            capsys.readouterr()
            ask(program, guess=right)
            assert f'Right: {right!r}.' in capsys.readouterr().out
            wrong = 'something else'
            ask(program, guess=wrong)
            said = capsys.readouterr().out
            assert f"You guessed 'something else', and it is {right!r}." in said
            assert EXPLAINED[name][asked[1]] in said
    stop()


def test_no_program_runs_without_a_guess(capsys):
    ask(lambda run: pytest.fail('it ran'))
    assert capsys.readouterr().out.startswith('Write your guess in place of `...`')


@pytest.mark.starts
def test_a_program_that_does_not_end_is_reported_and_no_guess_is_judged(capsys):
    def waits(run):
        raise TimeoutError('waited 20 s')

    ask(waits, guess=1)
    said = capsys.readouterr().out
    assert 'did not run to its end: TimeoutError: waited 20 s. That says nothing' in said
    assert 'You guessed' not in said


@pytest.mark.starts
def test_a_name_of_a_cell_that_has_not_run_is_no_reason_to_run_the_same_cell_again(capsys):
    def uses_a_class_of_another_cell(run):
        run(Gripper)  # noqa: F821

    with pytest.raises(NameError, match='Gripper'):
        ask(uses_a_class_of_another_cell, guess=1)
    assert 'run the cell again' not in capsys.readouterr().out


SAME = [(1, 1.0), ((2, 3), [2, 3]), (0.1 + 0.2, 0.3), (None, None), (True, True)]
OTHER = [(1, True), ('True', True), ([1], 1), ([1], [1, 2]), (object(), 1), (0, None), ('', [])]


@pytest.mark.parametrize(('guess', 'seen'), SAME)
def test_a_guess_that_equals_the_result_is_the_same(guess, seen):
    assert is_same(guess, seen)


@pytest.mark.parametrize(('guess', 'seen'), OTHER)
def test_a_guess_of_another_value_or_type_is_not_the_same(guess, seen):
    assert not is_same(guess, seen)


def test_each_program_in_the_table_of_results_is_defined_in_a_quiz():
    defined = {
        node.name
        for name in ALL
        for source in sources(name)
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef)
    }
    assert set(RETURNED) <= defined
    asked = [GUESS.search(source) for name in ALL for source in sources(name)]
    assert {each[1] for each in asked if each} == set(RETURNED)


@each_quiz
def test_links_of_a_quiz_lead_to_files_in_each_edition(name):
    for folder in (ROOT / 'notebooks', ROOT / 'notebooks/zh_CN'):
        quiz = nbformat.read(folder / name, as_version=4)
        links = re.findall(r'\]\((.+?)\)', '\n'.join(cell.source for cell in quiz.cells))
        assert len(links) >= 2
        assert [link for link in links if not (folder / link).is_file()] == []
