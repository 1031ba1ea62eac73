"""Answers that are alike are shown side by side, whatever their names and layout."""

import ast
import re

import pytest
from answer_table import answers_to
from course_maker import TOY, answered, executed, released_course, submit
from nbgrader.api import Gradebook

from grader.common.parsing import ParsingFailed
from grader.grade import SubmissionOutcome
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.report import similar_answers
from grader.report.fingerprints import find_pairs
from grader.report.report import Run, write_report
from grader.report.similar_answers import find_similar
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from tests.test_report import RUN

SKELETON = 'class FiveHz(Node):\n    def __init__(self):\n        # YOUR CODE HERE\n        pass\n'
ADA = """class FiveHz(Node):
    def __init__(self):
        super().__init__('kinematics_publisher')
        self.count = 0
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.create_timer(0.2, self.publish)

    def publish(self):
        self.count += 1
        angle = math.sin(self.count / 10) * LIMIT if self.count % 7 else -LIMIT / 3
        stamp = self.get_clock().now().to_msg()
        header = Header(stamp=stamp, frame_id='base_link')
        self.publisher.publish(JointState(header=header, name=NAMES, position=[angle, -angle]))
"""
CLEO = """class FiveHz(Node):
    def __init__(self, period=1 / 5):
        super().__init__('kinematics_publisher')
        make = self.create_publisher
        self.out = make(JointState, '/kinematics/joint_states', qos_profile=10)
        self.random = random.Random(7)
        self.timer = self.create_timer(period, self.on_timer)

    def on_timer(self):
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base_link'
        for name, (low, high) in LIMITS.items():
            message.name.append(name)
            message.position.append(self.random.uniform(low, high))
        self.out.publish(message)
"""


def disguised(code):
    """The same with other names, strings, comments and layout."""
    names = ('count', 'publisher', 'publish', 'angle', 'stamp', 'header')
    for number, name in enumerate(names):
        code = re.sub(rf'\b{name}\b', f'my_name_{number}', code)
    tree = ast.parse(code.replace("'base_link'", "'world'"))
    return '# all my own work\n' + ast.unparse(tree).replace('\n', '\n\n')


def found(answers, released=SKELETON):
    return [tuple(each['students']) for each in find_pairs(answers, released, 10)]


def test_a_copy_with_other_names_strings_comments_and_layout_is_found_and_shown():
    answers = {'ada': ADA, 'bob': disguised(ADA), 'cleo': CLEO}
    (pair,) = find_pairs(answers, SKELETON, 10)
    assert pair['students'] == ['ada', 'bob']
    assert pair['share'] > 0.8
    assert re.sub('</?mark>', '', pair['texts'][0]).replace('&#39;', "'") == ADA
    assert 'self.count % 7' in ' '.join(re.findall(r'<mark>(.*?)</mark>', pair['texts'][0], re.S))


def test_a_copied_part_of_an_answer_is_found():
    half = ADA[ADA.index('    def publish') :]
    other = CLEO[: CLEO.index('    def on_timer')].replace('self.on_timer', 'self.publish') + half
    assert found({'ada': ADA, 'dan': half.replace('angle', 'theta'), 'cleo': CLEO, 'eve': other})


def test_two_independent_answers_are_not_called_alike():
    assert found({'ada': ADA, 'cleo': CLEO}) == []


def test_released_code_and_answers_of_many_students_do_not_count_as_copies():
    assert found({'ada': ADA, 'bob': ADA}, released=ADA) == []
    class_of_20 = {f'student{number}': ADA for number in range(20)}
    assert found(class_of_20) == []
    assert found(dict(list(class_of_20.items())[:2])) == [('student0', 'student1')]


def test_short_answers_are_not_compared():
    short = 'def reach(l1, l2):\n    return abs(l1 - l2), l1 + l2\n'
    assert found({'ada': short, 'bob': short}) == []


def test_few_of_many_answers_written_to_differ_are_called_alike():
    # each was written to be unlike the others
    answers = {each.id: each.code for each in answers_to('five_hz') if each.points == each.full}
    assert len(answers) >= 10
    pairs = found(answers, released='')
    assert len(pairs) <= len(answers) / 4, pairs


def test_html_in_the_text_of_an_answer_is_escaped():
    evil = ADA.replace("'base_link'", "'</pre><script>'")
    (pair,) = find_pairs({'ada': evil, 'bob': evil}, SKELETON, 10)
    assert '<script>' not in pair['texts'][0]
    assert set(re.findall('<[^>]*>', pair['texts'][0])) == {'<mark>', '</mark>'}


@pytest.fixture
def course(tmp_path):
    return released_course(tmp_path)


LONG = 'def double(x):\n    total = 0\n' + ''.join(
    f'    if x == {number}:\n        total = total + {number} * x - len(str(x)) * ({number} - x)\n'
    for number in range(4)
)


def graded(course, student, answer):
    submit(course, student, answered(course, answer))
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    stored = store(course, submission, executed(sanitize_restored(course, TOY, restored), {}))
    return SubmissionOutcome(student, TOY, stored, stored.reason, 1.0)


def scores_in(course):
    with Gradebook(course.db_url) as book:
        return {each.student.id: each.score for each in book.assignment_submissions(TOY)}


def test_the_report_shows_similar_answers_side_by_side_and_scores_stay(course):
    rows = [
        graded(course, 'ada', LONG),
        graded(course, '<b>bob', LONG.replace('total', 'sum_') + '# \u202e\n'),
    ]
    scores = scores_in(course)
    page = write_report(course, Run(RUN.began), rows).read_text(encoding='utf-8')
    assert '100 % of <code>double</code>' in page
    assert '&lt;b&gt;bob and ada' in page
    assert page.count('<mark>') >= 2
    assert '\u202e' not in page  # it would reverse the line that follows
    assert scores_in(course) == scores
    assert len(scores) == 2


def test_a_report_without_similar_answers_has_no_section_for_them(course):
    page = write_report(course, Run(RUN.began), [graded(course, 'ada', LONG)])
    assert 'Answers that are alike' not in page.read_text(encoding='utf-8')


def test_answers_that_could_not_be_compared_are_reported_as_a_problem(course, monkeypatch):
    def fails(*arguments, limits):
        raise ParsingFailed('it took more than 60 s')

    for student in ('ada', 'bob'):
        graded(course, student, LONG)
    monkeypatch.setattr(similar_answers, 'parse', fails)
    similar = find_similar(course, [TOY])
    assert similar.pairs == ()
    assert similar.problems == (
        f'{TOY}, double: answers were not compared, because it took more than 60 s',
    )


@pytest.mark.parametrize('more', ['#' * 20_000, '\u202e' * 10_000])
def test_an_answer_that_is_far_too_long_is_not_compared(course, monkeypatch, more):
    for student, text in (('ada', LONG), ('bob', LONG), ('eve', f'{LONG}# {more}')):
        graded(course, student, text)
    compared = []
    monkeypatch.setattr(
        similar_answers, 'parse', lambda _, answers, *__, **___: compared.append(answers) or []
    )
    find_similar(course, [TOY])
    assert [answers.keys() for answers in compared] == [{'ada', 'bob'}]
