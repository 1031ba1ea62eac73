"""A NameError says which cell of the lesson has to run first."""

import pytest
from answered import ROOT
from opened_lesson import OpenedLesson

SAID = (
    '`{}` comes from cell {} of this lesson, which has not run to its end since the kernel '
    'started: run that cell first, or choose Run → Run All Above Selected Cell; then run this one '
    'again'
)


@pytest.fixture
def lesson():
    opened = OpenedLesson(ROOT / 'notebooks/01_topics/01_topics.ipynb')
    yield opened
    opened.close()


def number(lesson, cell_id):
    return 1 + [*lesson.cells].index(cell_id)


def test_a_name_of_a_cell_above_that_has_not_run_is_explained(lesson):
    for missing, cell_id in {'stop': 'imports', 'Station': 'station', 'Radio': 'radio'}.items():
        assert f"name '{missing}' is not defined" in lesson.run('late')
        assert lesson.printed.endswith(SAID.format(missing, number(lesson, cell_id)))
        assert lesson.run(cell_id) == ''
    assert lesson.run('late') == ''
    assert SAID.partition('comes')[2][:30] not in lesson.printed


def test_a_cell_above_that_stopped_is_named_too(lesson):
    assert 'No module' in lesson.run('imports', f'import nothing_here\n{lesson.cells["imports"]}')
    assert "name 'stop' is not defined" in lesson.run('station', 'stop')
    assert lesson.printed == SAID.format('stop', number(lesson, 'imports'))


def test_any_other_missing_name_is_not(lesson):
    assert lesson.run('imports') == ''
    for name, source in {
        'late': 'sation',  # in no cell
        'station': 'Radio',  # in a cell below
        'graph': 'stop\ndel stop\nstop',  # its cell has run
    }.items():
        assert 'is not defined' in lesson.run(name, source)
        assert 'comes from cell' not in lesson.printed
