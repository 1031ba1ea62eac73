from datetime import datetime, timedelta

import nbformat
import pytest
from course_maker import TOY, add_lesson, make_course, toy_lesson, write_source

from grader.__main__ import main
from grader.authoring.leaks import MARKS
from grader.authoring.release import release
from grader.course import Course
from grader.export.sample_solutions import write_solutions
from grader.storage.due_dates import set_due

MARK_SCHEME = '## Explain\n### BEGIN MARK SCHEME\nHalf a point for a try.\n### END MARK SCHEME'


@pytest.fixture
def course(tmp_path):
    course = make_course(tmp_path)
    lesson = toy_lesson()
    lesson.cells[4].source += '\n    ### BROKEN: return x - x'
    lesson.cells.insert(-1, nbformat.v4.new_markdown_cell(MARK_SCHEME, id='explain-text'))
    write_source(course, lesson)
    return course


def in_days(days):
    return datetime.now().astimezone() + timedelta(days=days)


def test_solutions_have_the_answers_and_nothing_that_is_hidden(course):
    (path,) = write_solutions(course).paths
    cells = {cell.id: cell for cell in nbformat.read(path, as_version=4).cells}
    assert cells['double'].source == (
        'def double(x):\n    """Return twice x."""\n    return x + x  # the secret answer'
    )
    assert cells['explain'].source == 'Because it is added to itself.'
    assert cells['explain-text'].source == '## Explain'
    assert cells['shown'].outputs
    text = path.read_text(encoding='utf-8')
    assert 'canary' not in text
    assert not [mark for mark in MARKS if mark in text]


def test_each_lesson_has_a_solution_that_runs_as_python(tmp_path):
    paths = write_solutions(Course(gradebook=tmp_path)).paths
    assert len(paths) == len(Course().assignments()) >= 8
    for path in paths:
        text = path.read_text(encoding='utf-8')
        assert not [mark for mark in MARKS if mark in text]
        notebook = nbformat.read(path, as_version=4)
        answers = [c for c in notebook.cells if c.metadata.get('nbgrader', {}).get('solution')]
        packages = Course().packages(path.stem)
        assert answers or packages
        assert all((path.parent / package / 'package.xml').is_file() for package in packages)
        for cell in answers:
            if cell.cell_type == 'code':
                compile(cell.source, path.name, 'exec')


def test_solutions_are_not_written_while_a_student_may_still_submit(course, capsys):
    set_due(course, TOY, in_days(-2))
    set_due(course, TOY, in_days(1), student_id='ada')
    assert main(['solutions'], course=course) == 1
    assert f'{TOY} can be handed in until' in capsys.readouterr().err
    assert not (course.gradebook / 'solutions').exists()
    assert main(['solutions', TOY, '--early'], course=course) == 0
    set_due(course, TOY, None, student_id='ada')
    assert main(['solutions', TOY], course=course) == 0


@pytest.fixture
def solutions(course):
    for name in ('01_open', '02_extended', '03_undated'):
        add_lesson(course, name)
    set_due(course, TOY, in_days(-2))
    set_due(course, '01_open', in_days(1))
    set_due(course, '02_extended', in_days(-2))
    set_due(course, '02_extended', in_days(1), student_id='ada')
    return course.gradebook / 'solutions'


def test_an_open_lesson_does_not_stop_the_solutions_of_closed_ones(course, solutions, capsys):
    assert main(['solutions'], course=course) == 0
    assert [path.name for path in solutions.iterdir()] == [f'{TOY}.ipynb']
    path, *left_out, after = capsys.readouterr().out.splitlines()
    assert path == str(solutions / f'{TOY}.ipynb')
    assert left_out[0] == 'Not written, because students may still submit:'
    assert [line.partition(' can be handed in until ')[0] for line in left_out[1:3]] == [
        '  01_open',
        '  02_extended',
    ]
    assert left_out[3:] == ['  03_undated has no due date (./course due)']
    assert './course solutions' in after
    assert '--early' in after


def test_an_open_lesson_is_written_only_early_and_an_undated_one_by_name(
    course, solutions, capsys
):
    assert main(['solutions', '02_extended'], course=course) == 1
    assert '02_extended can be handed in until' in capsys.readouterr().err
    assert not solutions.exists()
    assert main(['solutions', '03_undated'], course=course) == 0
    assert [path.stem for path in solutions.iterdir()] == ['03_undated']
    assert main(['solutions', '--early'], course=course) == 0
    assert len(list(solutions.iterdir())) == 4
    assert 'Not written' not in capsys.readouterr().out
    assert main(['solutions'], course=course) == 0
    said = 'has answers from before, for 01_open, 02_extended, 03_undated: unless students have '
    assert said in capsys.readouterr().out


@pytest.mark.parametrize('extension', [{}, {'student_id': 'ada'}])
def test_answers_of_a_lesson_that_is_open_again_are_named_and_stay(course, capsys, extension):
    set_due(course, TOY, in_days(-1))
    assert main(['solutions'], course=course) == 0
    path = course.solution_path(TOY)
    before = path.read_bytes()
    student = ['--student', 'ada'] if extension else []
    capsys.readouterr()
    main(['due', TOY, f'{in_days(1):%Y-%m-%d}', *student], course=course)
    said = f'gradebook/solutions/{TOY}.ipynb has our answers, and {TOY} can be handed in until '
    assert said in capsys.readouterr().out
    assert main(['solutions'], course=course) == 1
    said = f'gradebook/solutions/ has answers from before, for {TOY}: unless students have them '
    assert said in capsys.readouterr().err
    assert path.read_bytes() == before
    path.unlink()
    main(['due'], course=course)
    assert 'has our answers' not in capsys.readouterr().out


@pytest.mark.starts  # to release takes long
def test_a_mark_scheme_is_kept_out_of_the_release(course):
    release(course)
    cells = {cell.id: cell.source for cell in course.release(TOY).cells}
    assert cells['explain-text'] == '## Explain'
    template = {cell.id: cell.source for cell in course.template(TOY).notebook.cells}
    assert template['explain-text'] == MARK_SCHEME
