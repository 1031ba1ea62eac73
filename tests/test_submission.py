"""Reading submitted notebooks: every oddity is reported in a sentence, none by a traceback."""

import contextlib
import json
import os
import resource
import time

import nbformat
import pytest
from course_maker import PIXEL
from hostile_papers import CODE, ONE_MEGABYTE, notebook_text
from nbformat.v4 import new_code_cell, new_notebook

from grader.common.errors import CourseError, UnreadableSubmission
from grader.notebook import raw_notebook, reading
from grader.notebook.raw_notebook import MAX_CELLS, MAX_CHARACTERS, MAX_PICTURES
from grader.notebook.reading import read_notebook
from grader.notebook.submission import (
    MAX_PYTHON_BYTES,
    MAX_PYTHON_FILES,
    read_submission,
)

NAME = '03_publisher.ipynb'


@pytest.fixture
def read(tmp_path):
    def read(content):
        path = tmp_path / NAME
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_notebook(path)

    return read


UNREADABLE = {
    'empty': ('', 'is empty: save'),
    'binary': (bytes(range(256)), 'is not JSON'),
    'cut short': (notebook_text(CODE)[:-20], 'is not JSON'),
    'a web page': ('\ufeff\n<!DOCTYPE html><html>', 'is a web page, not a notebook'),
    'an archive': (b'PK\x03\x04' + bytes(40), 'is a zip archive'),
    'a merge conflict': (
        '{\n "cells": [\n<<<<<<< HEAD\n  1\n=======\n  2\n>>>>>>> other\n ]\n}',
        'has a merge conflict of Git in line 3',
    ),
    'only a word of one': ('{\n "a": "<<<<<<< HEAD"\n', 'is not JSON'),
    'nested deeply': ('[' * 100_000, 'is not JSON'),
    'nested deeply, closed': ('[' * 100_000 + ']' * 100_000, 'is not JSON'),
    'UTF-16 without a mark': (notebook_text(CODE).encode('utf-16-be')[:-1], 'is not JSON'),
    'a huge number': ('{"nbformat": ' + '9' * 5000 + '}', 'is not JSON'),
    'a list': ('[]', 'is JSON but not a notebook'),
    'null': ('null', 'is JSON but not a notebook'),
    'a string': ('"notebook"', 'is JSON but not a notebook'),
    'another kind of object': ('{"cells": []}', 'is JSON but not a notebook'),
    'nbformat is text': (notebook_text(CODE, nbformat='4'), 'is JSON but not a notebook'),
    'no cells': (notebook_text(), 'has no cells'),
    'cells are missing': ('{"nbformat": 4}', 'has no cells'),
    'cells are a number': ('{"nbformat": 4, "cells": 7}', 'has no cells'),
    'cells are an object': ('{"nbformat": 4, "cells": {"a": 1}}', 'has no cells'),
    'cells hold no objects': ('{"nbformat": 4, "cells": [1, null, "x", []]}', 'has no cells'),
    'old, worksheets are a number': ('{"nbformat": 3, "worksheets": 7}', 'has no cells'),
    'too many cells': (notebook_text(*[CODE] * (MAX_CELLS + 1)), 'cells, more than the 800'),
    'too much text': (
        notebook_text(*[CODE | {'source': 'x' * 100_000}] * (MAX_CHARACTERS // 100_000 + 1)),
        'has 600,000 characters',
    ),
}  # fmt: skip


@pytest.mark.parametrize('said', ['zh_CN', 3, ['zh_CN'], {'a': 1}, '', 'x' * 30, '../..', 'zh CN'])
def test_only_a_valid_language_of_the_notebook_metadata_is_kept(read, said):
    ours = {'language': said, 'notes': ['forged'], 'title': 'forged'}
    kept = {'my_robot_basics': {'language': said}} if said == 'zh_CN' else {}
    text = notebook_text(CODE, metadata={'my_robot_basics': ours, 'more': 1})
    assert read(text).metadata == kept


@pytest.mark.parametrize(('content', 'reason'), UNREADABLE.values(), ids=UNREADABLE)
def test_an_unreadable_notebook_is_refused_in_one_line_with_a_reason(read, content, reason):
    with pytest.raises(UnreadableSubmission) as refused:
        read(content)
    sentence = str(refused.value)
    assert reason in sentence
    assert NAME in sentence
    assert '\n' not in sentence
    assert len(sentence) < 400


CELLS = {
    'source as text': (CODE, 'x = 1'),
    'source as lines': (CODE | {'source': ['a\n', 'b']}, 'a\nb'),
    'lines of several types': (CODE | {'source': ['a', 1, None, ['b'], 'c']}, 'ac'),
    'source is missing': ({'cell_type': 'code'}, ''),
    'source is a number': (CODE | {'source': 5}, ''),
    'source is an object': (CODE | {'source': {'a': 1}}, ''),
    'a lone surrogate': (CODE | {'source': 'a\ud800b'}, 'a?b'),
    'another alphabet': (CODE | {'source': 'θ = "角度"'}, 'θ = "角度"'),
    'a NUL': (CODE | {'source': 'a\0b'}, 'a\0b'),
    'outputs of any type': (CODE | {'outputs': 'forged'}, 'x = 1'),
    'metadata is a list': (CODE | {'metadata': [1]}, 'x = 1'),
    'nbgrader is text': (CODE | {'metadata': {'nbgrader': 'solution'}}, 'x = 1'),
    'grade id is long': (CODE | {'metadata': {'nbgrader': {'grade_id': 'a' * 999}}}, 'x = 1'),
    'grade id is a list': (CODE | {'metadata': {'nbgrader': {'grade_id': ['a']}}}, 'x = 1'),
    'id is a number': (CODE | {'id': 9}, 'x = 1'),
    'id is a surrogate': (CODE | {'id': '\ud800'}, 'x = 1'),
    'unknown type': ({'cell_type': 7, 'source': 'text'}, 'text'),
}  # fmt: skip


@pytest.mark.parametrize(('cell', 'source'), CELLS.values(), ids=CELLS)
def test_every_odd_cell_becomes_a_valid_one_without_metadata_or_outputs(read, cell, source):
    clean = read(notebook_text(cell))
    assert [c.source for c in clean.cells] == [source]
    assert clean.cells[0].metadata == {}
    assert clean.cells[0].get('outputs', []) == []
    nbformat.writes(clean).encode()  # no surrogate, nothing that is not JSON


@pytest.mark.parametrize('kind', ['code', 'markdown', 'raw'])
def test_a_cell_saved_with_crlf_has_the_text_that_was_released(read, kind):
    for source in ('a\r\nb', ['a\r\n', 'b'], ['a\r', '\nb']):
        (cell,) = read(notebook_text({'cell_type': kind, 'source': source})).cells
        assert cell.source == 'a\nb'


@pytest.mark.parametrize('kind', ['code', 'markdown', 'raw'])
def test_only_the_grade_id_of_a_cells_metadata_is_kept(read, kind):
    marks = {'grade_id': 'five_hz', 'points': 99, 'schema_version': 1, 'solution': False}
    metadata = {
        'nbgrader': marks,
        'tags': ['skip-execution', 'demo'],
        'my_robot_basics': {'role': 'setup', 'outcome': 'passed'},
    }
    clean = read(notebook_text({'cell_type': kind, 'source': 'x', 'metadata': metadata}))
    assert clean.cells[0].metadata == {'nbgrader': {'grade_id': 'five_hz'}}
    assert clean.cells[0].cell_type == kind
    assert clean.metadata == {}


def test_notebooks_of_older_formats_are_read(read):
    four = {'cell_type': 'code', 'source': 'x = 1', 'metadata': {'nbgrader': {'grade_id': 'a'}}}
    three = {'cell_type': 'code', 'input': 'x = 1', 'metadata': {'nbgrader': {'grade_id': 'a'}}}
    worksheets = [{'cells': [three]}, 5, {'cells': None}]
    for text in (
        notebook_text(four, nbformat_minor=0),
        notebook_text(four, nbformat_minor='x'),
        json.dumps({'nbformat': 3, 'worksheets': worksheets}),
    ):
        (cell,) = read(text).cells
        assert (cell.source, cell.metadata.nbgrader.grade_id) == ('x = 1', 'a')


ATTACHMENTS = {
    'a picture': ({'a.png': {'image/png': PIXEL}}, {'a.png': {'image/png': PIXEL}}),
    'no picture': ({'a.png': {'image/png': 'AAAA'}}, None),
    'a script in a picture': ({'a.svg': {'image/svg+xml': '<script/>'}}, None),
    'a web page': ({'a': {'text/html': '<b>', 'image/png': PIXEL}}, {'a': {'image/png': PIXEL}}),
    'data of another type': ({'a.png': {'image/png': ['AAAA']}}, None),
    'a list': ([1], None),
    'a bundle of another type': ({'a.png': 'AAAA'}, None),
}


@pytest.mark.parametrize(('attachments', 'kept'), ATTACHMENTS.values(), ids=ATTACHMENTS)
def test_only_pictures_are_kept_of_attachments(read, attachments, kept):
    cell = {'cell_type': 'markdown', 'source': 'x', 'attachments': attachments}
    assert read(notebook_text(cell)).cells[0].get('attachments') == kept


def test_the_name_of_a_picture_is_shortened_and_made_encodable(read):
    pictures = {'\ud800' + 'a' * 300: {'image/png': PIXEL}}
    cell = {'cell_type': 'markdown', 'source': 'x', 'attachments': pictures}
    clean = read(notebook_text(cell))
    assert list(clean.cells[0].attachments) == ['?' + 'a' * 254]
    nbformat.writes(clean).encode()


def test_a_notebook_with_too_many_pictures_is_refused(read):
    pictures = {str(n): {'image/png': PIXEL} for n in range(MAX_PICTURES)}
    cell = {'cell_type': 'markdown', 'source': 'x', 'attachments': pictures}
    assert len(read(notebook_text(cell)).cells[0].attachments) == MAX_PICTURES
    with pytest.raises(UnreadableSubmission, match='400 pasted pictures, more than the 200 that'):
        read(notebook_text(cell, cell))


def test_a_submitted_notebook_is_parsed_in_another_process(read, monkeypatch):
    def parsed_here(path):
        raise AssertionError(path)

    monkeypatch.setattr(raw_notebook, '_read_json', parsed_here)
    assert read(notebook_text(CODE)).cells[0].source == 'x = 1'
    with pytest.raises(AssertionError):
        raw_notebook.read('here')


@pytest.mark.parametrize('content', ONE_MEGABYTE.values(), ids=ONE_MEGABYTE)
def test_reading_a_hostile_megabyte_takes_little_processor_time_of_the_grader(read, content):
    """By nbformat, which checks all of its schema, 30,000 outputs took 39 s and 1.4 GB."""
    began = time.process_time()
    with contextlib.suppress(UnreadableSubmission):
        read(content)
    assert time.process_time() - began < 2.0


FORGED = {
    'nothing': {},
    'no cells': {'cells': []},
    'a cell of another type': {'cells': [{'id': 'a', 'cell_type': 'x', 'metadata': {}}]},
    'a verdict': {
        'cells': [
            {'id': 'a', 'cell_type': 'code', 'source': '', 'metadata': {'my_robot_basics': {}}}
        ]
    },
    'an output': {
        'cells': [{'id': 'a', 'cell_type': 'code', 'source': '', 'metadata': {}, 'outputs': [1]}]
    },
    'a long grade id': {
        'cells': [
            {
                'id': 'a',
                'cell_type': 'raw',
                'source': '',
                'metadata': {'nbgrader': {'grade_id': 'a' * 129}},
            }
        ]
    },
    'a newline in an id': {
        'cells': [{'id': 'a\n', 'cell_type': 'raw', 'source': '', 'metadata': {}}]
    },
    'both': {'cells': [], 'problem': 'x'},
    'a problem that is none': {'problem': ''},
    'text': 'cells',
}


@pytest.mark.parametrize('said', FORGED.values(), ids=FORGED)
def test_a_malformed_reply_of_the_parser_is_not_blamed_on_the_submission(
    tmp_path, monkeypatch, said
):
    monkeypatch.setattr(reading, 'parse', lambda *arguments, **options: said)
    with pytest.raises(CourseError, match='returned no notebook') as refused:
        read_notebook(tmp_path / NAME)
    assert not isinstance(refused.value, UnreadableSubmission)  # that would be a zero


def test_a_huge_file_is_refused_by_its_size_without_reading_it(tmp_path):
    path = tmp_path / NAME
    with path.open('wb') as file:
        file.truncate(50_000_000)
    with pytest.raises(UnreadableSubmission, match='has 50 MB, more than 20 MB: choose "Clear'):
        read_notebook(path)


def test_the_reason_for_a_missing_notebook_names_the_files_found(tmp_path):
    (tmp_path / '作业.ipynb').write_text('{}')
    with pytest.raises(UnreadableSubmission, match=r'no file 03_publisher\.ipynb; found 作业'):
        read_notebook(tmp_path / NAME)
    with pytest.raises(UnreadableSubmission, match='found nothing'):
        read_notebook(tmp_path / 'nowhere' / NAME)


def test_a_symbolic_link_or_a_folder_is_refused_as_a_notebook(tmp_path):
    (tmp_path / 'secret.ipynb').write_text(notebook_text(CODE))
    (tmp_path / NAME).symlink_to(tmp_path / 'secret.ipynb')
    (tmp_path / 'folder.ipynb').mkdir()
    for name in (NAME, 'folder.ipynb'):
        with pytest.raises(UnreadableSubmission, match='there is no file'):
            read_notebook(tmp_path / name)


@pytest.mark.parametrize('student', ['ada', '李雷', 'Ольга', 'o’brien', '🐢', 'a b'])
def test_a_student_name_in_any_alphabet_is_read(tmp_path, student):
    folder = tmp_path / student / '03_publisher'
    folder.mkdir(parents=True)
    nbformat.write(new_notebook(cells=[new_code_cell('x = 1')]), folder / NAME)
    submission = read_submission(folder, student_id=student, assignment='03_publisher')
    assert submission.problem is None
    assert submission.student_id == student
    assert submission.path == folder / NAME
    assert [cell.source for cell in submission.notebook.cells] == ['x = 1']


def test_a_missing_notebook_is_recorded_as_the_submissions_problem(tmp_path):
    submission = read_submission(tmp_path, student_id='ada', assignment='03_publisher')
    assert submission.notebook is None
    assert 'there is no file 03_publisher.ipynb' in submission.problem


def test_only_plain_python_files_beside_the_notebook_are_extra(tmp_path):
    for name in ('b.py', 'a.py', 'data.csv', 'notes.ipynb'):
        (tmp_path / name).write_text('')
    (tmp_path / 'folder.py').mkdir()
    (tmp_path / 'deeper').mkdir()
    (tmp_path / 'deeper' / 'c.py').write_text('')
    (tmp_path / 'link.py').symlink_to(tmp_path / 'a.py')
    submission = read_submission(tmp_path, student_id='ada', assignment='03_publisher')
    assert submission.extra_files == (tmp_path / 'a.py', tmp_path / 'b.py')


def test_reading_a_submission_changes_no_file(tmp_path):
    path = tmp_path / NAME
    path.write_text(notebook_text(CODE))
    before = (path.read_bytes(), path.stat().st_mtime_ns, sorted(tmp_path.iterdir()))
    read_submission(tmp_path, student_id='ada', assignment='03_publisher')
    assert (path.read_bytes(), path.stat().st_mtime_ns, sorted(tmp_path.iterdir())) == before


def test_a_notebook_of_millions_of_cells_is_refused_at_little_memory(read):
    """Read in this process, it took 7 GB."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    cells = ','.join(['{}'] * 6_000_000)
    with pytest.raises(UnreadableSubmission, match=r'the 800 that are graded|too much memory'):
        read(f'{{"nbformat": 4, "cells": [{cells}]}}')
    kilobytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert kilobytes < 400_000  # of which this test itself takes some


def test_modules_that_are_too_many_or_too_large_are_left_out_with_a_note(tmp_path):
    for name in ('a', 'b'):
        (tmp_path / f'{name}.py').write_text('x = 1')
    (tmp_path / 'large.py').write_bytes(b'#' * (MAX_PYTHON_BYTES + 1))
    for number in range(MAX_PYTHON_FILES):
        (tmp_path / f'z{number:03}.py').touch()
    submission = read_submission(tmp_path, student_id='ada', assignment='02_joint_state')
    names = [path.name for path in submission.extra_files]
    assert names[:2] == ['a.py', 'b.py']
    assert len(names) == MAX_PYTHON_FILES
    assert 'large.py' not in names
    assert len(submission.notes) == 3
    assert submission.notes[0].startswith('the file `large.py` of 2.0 MB was left out: at most 50')


STRANGE = {
    b'x' * 252 + b'.py': 'x' * 59 + '…',
    b'x\xff.py': 'x\\udcff.py',
    b'.py': '.py',
    'a\u202eb.py'.encode(): 'a\\u202eb.py',
}


@pytest.mark.parametrize('name', STRANGE)
@pytest.mark.parametrize('size', [5, MAX_PYTHON_BYTES + 1])
def test_a_module_with_an_unusable_name_is_left_out_with_a_note(tmp_path, name, size):
    (tmp_path / 'a.py').touch()
    (tmp_path / os.fsdecode(name)).write_bytes(b'#' * size)
    submission = read_submission(tmp_path, student_id='ada', assignment='02_joint_state')
    assert [path.name for path in submission.extra_files] == ['a.py']
    (note,) = submission.notes
    assert note.startswith(
        f'the file `{STRANGE[name]}` was left out: its name begins with a dot, '
    )
    note.encode()


def test_a_module_that_is_a_symbolic_link_is_left_out_with_a_note(tmp_path):
    (tmp_path / 'a.py').touch()
    (tmp_path / 'b.py').symlink_to('a.py')
    submission = read_submission(tmp_path, student_id='ada', assignment='02_joint_state')
    assert submission.notes == ('the file `b.py` was left out: it is a link',)


def test_ten_of_many_left_out_modules_are_named_and_the_rest_are_counted(tmp_path):
    for number in range(30):
        (tmp_path / f'{number}\u202e.py').touch()
    submission = read_submission(tmp_path, student_id='ada', assignment='02_joint_state')
    assert len(submission.notes) == 11
    assert submission.notes[-1] == '20 more Python files were left out'
