import re

import nbformat
import pytest
from course_maker import PIXEL, TOY, make_course, toy_lesson, write_source
from nbformat.v4 import new_code_cell, new_notebook, new_output

from grader.authoring.demo_outputs import clean_source, keep_outputs, read_sanitizer
from grader.authoring.release import release, stale_or_leaking
from grader.course import ROOT, Course

RULES = """
[measured]
regex: \\d+ ms
replace: some ms

[pixels]
regex: src="data:image/png;base64,[^"]*"
replace: src="a picture"
"""
OTHER_PIXEL = PIXEL.replace('Y', 'Z', 1)


def picture(words, pixels=PIXEL):
    page = f'<img alt="{words}" src="data:image/png;base64,{pixels}">'
    data = {'image/png': pixels, 'text/html': page, 'text/plain': words}
    return new_output('display_data', data=data, metadata={'image/png': {'alt': words}})


def said(text):
    return new_output('stream', text=text)


def lesson(*outputs, source='measure()', tags=('demo',)):
    cell = new_code_cell(source, id='measured', metadata={'tags': list(tags)})
    cell.outputs = list(outputs)
    return new_notebook(cells=[cell])


@pytest.fixture(scope='module')
def sanitize(tmp_path_factory):
    path = tmp_path_factory.mktemp('rules') / 'rules.cfg'
    path.write_text(RULES)
    return read_sanitizer(path)


def outputs_of(notebook):
    return notebook.cells[0].outputs


def test_a_source_keeps_what_nbval_compares_and_no_pixels(sanitize):
    notebook = lesson(said('31 ms\n'), picture('an arm'))
    notebook.metadata.language_info = {'name': 'python', 'version': '3.11.7'}
    notebook.cells[0].metadata.execution = {'iopub.execute_input': '2026-11-01T10:00:00'}
    text, shown = outputs_of(cleaned := clean_source(notebook, sanitize))
    assert text.text == 'some ms\n'
    assert shown.data.keys() == {'text/html', 'text/plain'}
    assert shown.data['text/plain'] == 'an arm'
    assert 'execution' not in cleaned.cells[0].metadata
    assert cleaned.metadata.language_info == {'name': 'python'}
    assert outputs_of(notebook)[0].text == '31 ms\n'
    assert clean_source(cleaned, sanitize) == cleaned


def test_a_source_keeps_no_output_of_a_cell_that_differs_each_time(sanitize):
    notebook = lesson(said('31 ms\n'), tags=('demo', 'nbval-ignore-output'))
    assert outputs_of(clean_source(notebook, sanitize)) == []


def test_a_released_output_stays_if_nbval_considers_it_unchanged(sanitize):
    released = lesson(said('31 ms\n'), picture('an arm'))
    built = lesson(said('47 ms\n'), picture('an arm', OTHER_PIXEL))
    assert keep_outputs(built, released, sanitize) == []
    text, shown = outputs_of(built)
    assert text.text == '31 ms\n'
    assert PIXEL in shown.data['text/html']
    assert 'image/png' not in shown.data  # the picture is stored once


def test_outputs_missing_from_a_cleaned_source_come_from_the_last_release(sanitize):
    released = lesson(said('31 ms\n'), picture('an arm'))
    built = clean_source(released, sanitize)
    assert keep_outputs(built, released, sanitize, fresh=True) == []
    assert outputs_of(built) == outputs_of(released)


@pytest.mark.parametrize('tags', [('demo',), ('demo', 'nbval-ignore-output')])
def test_fresh_outputs_are_taken_only_if_they_are_asked_for(sanitize, tags):
    released, built = lesson(said('31 ms\n'), tags=tags), lesson(said('47 ms\n'), tags=tags)
    assert keep_outputs(built, released, sanitize, fresh=True) == []
    assert outputs_of(built)[0].text == '47 ms\n'
    assert keep_outputs(built, released, sanitize) == []
    assert outputs_of(built)[0].text == '31 ms\n'


def test_an_output_with_different_words_replaces_the_released_one(sanitize):
    released = lesson(said('31 ms\n'), picture('an arm'))
    built = lesson(said('late\n'), picture('two arms', OTHER_PIXEL))
    assert keep_outputs(built, released, sanitize) == []
    text, shown = outputs_of(built)
    assert text.text == 'late\n'
    assert OTHER_PIXEL in shown.data['text/html']


def test_changed_code_takes_its_new_picture_or_is_reported_as_lacking_one(sanitize):
    released = lesson(picture('an arm'))
    changed = lesson(picture('an arm', OTHER_PIXEL), source='measure(colour)')
    assert keep_outputs(changed, released, sanitize) == []
    assert OTHER_PIXEL in outputs_of(changed)[0].data['text/html']
    not_run = clean_source(lesson(picture('an arm'), source='measure(colour)'), sanitize)
    assert keep_outputs(not_run, released, sanitize) == ['measured']
    new = clean_source(lesson(picture('two arms')), sanitize)
    assert keep_outputs(new, released, sanitize) == ['measured']


def test_a_release_takes_the_pictures_out_of_the_source_and_keeps_its_own(tmp_path):
    course = make_course(tmp_path)
    assert any(f'solutions/{TOY}/{TOY}.ipynb holds' in line for line in stale_or_leaking(course))
    told = []
    release(course, say=told.append)
    assert told == [
        f'solutions/{TOY}/{TOY}.ipynb holds no pictures any more: they are in notebooks/ now'
    ]
    assert PIXEL not in course.source_path(TOY).read_text()
    assert PIXEL in course.release_path(TOY).read_text()
    assert stale_or_leaking(course) == []
    before = course.release_path(TOY).read_bytes()
    again = toy_lesson()
    again.cells[3 if again.cells[3].id == 'shown' else 2].outputs[1].data['image/png'] = (
        OTHER_PIXEL
    )
    write_source(course, again)
    assert release(course) == []
    assert course.release_path(TOY).read_bytes() == before


def test_a_picture_that_a_damaged_release_had_is_reported_and_can_be_taken_back(tmp_path):
    course = make_course(tmp_path)
    release(course)
    path = course.release_path(TOY)
    before = path.read_bytes()
    path.write_bytes(b'<<<<<<< HEAD\n' + before)
    told = []
    release(course, say=told.append)
    [missing] = [line for line in told if 'picture is missing' in line]
    assert f'because notebooks/{TOY}/{TOY}.ipynb could not be read. Take that file back' in missing
    path.write_bytes(before)
    told.clear()
    release(course, say=told.append)
    assert told == []
    assert path.read_bytes() == before


@pytest.mark.parametrize('path', sorted(ROOT.glob('solutions/*/*.ipynb')), ids=lambda p: p.stem)
def test_the_lessons_are_stored_as_cleaned_sources(path):
    sanitize = read_sanitizer(ROOT / 'solutions/nbval_sanitize.cfg')
    source = nbformat.read(path, as_version=4)
    assert clean_source(source, sanitize) == source
    assert sanitize('ROS_DOMAIN_ID=14') == 'ROS_DOMAIN_ID=N'  # the rules were found


@pytest.mark.parametrize('name', Course().assignments())
def test_each_picture_is_in_the_repository_once(name):
    outputs = [each for cell in Course().release(name).cells for each in cell.get('outputs', [])]
    data = [each.data for each in outputs if 'data' in each]
    assert not [each for each in data if 'image/png' in each]  # HTML has words for it, too
    pictures = [page for each in data if 'data:image' in (page := each.get('text/html', ''))]
    assert pictures or name == '12_package'  # it shows files and commands
    assert all(
        re.match(r'<img alt="[^"]+" src="data:image/png;base64,', each) for each in pictures
    )


@pytest.mark.parametrize('name', Course().assignments())
def test_no_edition_has_a_placeholder_instead_of_a_picture(name):
    editions = [*(ROOT / 'notebooks').glob(f'**/{name}.ipynb')]
    assert len(editions) == 2
    for path in editions:
        assert 'src=\\"a picture\\"' not in path.read_text(encoding='utf-8'), path
